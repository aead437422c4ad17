"""Checks of durations and fixed ends against the speed and acceleration limits of each joint alone.

A joint with |a| <= A and |v| <= V moves from (q_0, v_0) to (q_1, v_1) in the least time by accelerating to a peak speed
and braking. With the direction s = sign(q_1 - q_0 - (v_0 + v_1) |v_1 - v_0| / (2 A)) the peak is

    v_p = s sqrt((v_0^2 + v_1^2) / 2 + s A (q_1 - q_0)),

or s V, which the joint keeps, if that is less. Source: Lynch and Park, Modern Robotics (2017), section 9.2.2.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.problem.constraints.base import Where
from robotraj.problem.feasibility import Ends
from robotraj.problem.rows import RowTable
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

ROUNDING = 1e-9
"""Relative excess over a bound that counts as round-off."""
MILLI = 1e-3
"""Milliseconds in place of seconds: a duration that the speed limits allow in this unit too."""
LONG = 100.0
"""Least duration relative to what the speed limits need above which its unit is doubtful."""
GREATEST = 1e9
"""Largest acceleration [rad/s^2, m/s^2] that a message names as sufficient."""


@dataclass(frozen=True)
class _Travel:
    """Fixed positions and speeds of one joint at both ends, with its limits [SI]."""

    joint: str
    unit: str
    first: float
    last: float
    start_speed: float
    end_speed: float
    fastest: float
    acceleration: float

    def least_time(self, acceleration: float) -> float:
        """Return the least duration [s] with an acceleration limit."""
        gap, v0, v1 = self.last - self.first, self.start_speed, self.end_speed
        if acceleration == 0.0:
            return 0.0 if gap == 0.0 == v1 - v0 else gap / v0 if v0 == v1 and gap * v0 > 0.0 else np.inf
        way = 1.0 if gap >= 0.5 * (v0 + v1) * abs(v1 - v0) / acceleration else -1.0
        peak = way * np.sqrt(max(0.0, 0.5 * (v0**2 + v1**2) + way * acceleration * gap))
        if abs(peak) <= self.fastest:
            return float((abs(peak - v0) + abs(v1 - peak)) / acceleration)
        peak = way * self.fastest
        ramps = 0.5 * ((v0 + peak) * abs(peak - v0) + (peak + v1) * abs(v1 - peak)) / acceleration
        return float((abs(peak - v0) + abs(v1 - peak)) / acceleration + abs(gap - ramps) / self.fastest)

    def enough(self, duration: float) -> float | None:
        """Return an acceleration limit with which the duration [s] suffices; None where the speed limit is too low."""
        low, high = max(self.acceleration, 1.0 / GREATEST), GREATEST
        if self.least_time(high) > duration:
            return None
        for _ in range(80):
            middle = float(np.sqrt(low * high))
            low, high = (low, middle) if self.least_time(middle) <= duration else (middle, high)
        return high


def check_durations(
    table: RowTable, robot: Robot, limits: Limits | None, durations: tuple[float, float], ends: Ends
) -> None:
    """Refuse a joint that must travel faster than its limits allow in the longest of both durations [s].

    The limits are those of the phase and of its constraints, such as ``rt.constraints.JointVelocity``.

    Speeds limit every joint with fixed or bounded ends; accelerations those whose positions and speeds are fixed.

    Raises
    ------
    InputError
        A joint cannot travel the distance in time, or cannot brake inside its position limits. The message names the
        joint, the distance, and the duration or acceleration that suffices.

    Warns
    -----
    UserWarning
        The shortest duration is plausible in milliseconds only.
    """
    phase, bounds = table.phase, table.limits()
    shortest, longest = durations
    least = 0.0
    start, end = ends[Where.START], ends[Where.END]
    positions = robot.position_names
    for i, joint in enumerate(robot.velocity_names):
        if joint not in positions:
            continue  # the velocities of a floating root are no rates of single positions
        at, rate = positions.index(joint), robot.nq + i
        unit = robot.units[i]
        gap = max(end.lower[at] - start.upper[at], start.lower[at] - end.upper[at], 0.0)
        forward = start.upper[at] <= end.lower[at]
        slowest, fastest = _bounds(limits, "velocity", i, bounds.get(f"v.{joint}"))
        speed = fastest if forward else -slowest
        acceleration = max(map(abs, _bounds(limits, "acceleration", i, bounds.get(f"a.{joint}"))))
        if np.isfinite(gap) and gap > speed * longest * (1 + ROUNDING):
            raise InputError(
                f"Phase {phase!r}: joint {joint!r} must travel {gap:.4g} {unit}, but its velocity limit of "
                f"{speed:.4g} {unit}/s allows {speed * longest:.4g} {unit} in {longest:.4g} s. "
                f"Allow at least {gap / speed:.4g} s, or a velocity of at least {gap / longest:.4g} {unit}/s."
            )
        if np.isfinite(gap) and speed > 0.0:
            least = max(least, gap / speed)
        if not np.isfinite(acceleration):
            continue
        for sign, side, place in ((1.0, start, "start"), (-1.0, end, "end")):
            if side.lower[at] == side.upper[at] and side.lower[rate] == side.upper[rate]:
                room = _bounds(limits, "position", i, bounds.get(f"q.{joint}"))
                moved = float(side.lower[at]), sign * float(side.lower[rate])
                _check_braking(phase, joint, unit, place, moved, room, acceleration)
        fixed = all(side.lower[k] == side.upper[k] for side in (start, end) for k in (at, rate))
        if fixed and np.isfinite(longest):
            first, last = float(start.lower[at]), float(end.lower[at])
            speeds = float(start.lower[rate]), float(end.lower[rate])
            _check_travel(phase, _Travel(joint, unit, first, last, *speeds, speed, acceleration), longest)
    # Ends that fix no travel are those of steps, pushes and rests.
    needed = least or _own_time(robot)
    if 0.0 < needed <= MILLI * longest < np.inf and LONG * needed <= shortest:
        times = f", {shortest / least:.3g} times as long as its speed limits need" if least else ""
        warn(
            f"Phase {phase!r}: it takes at least {shortest:g} s{times}. The unit is s: {shortest:g} ms are "
            f"{MILLI * shortest:g} s."
        )


def _own_time(robot: Robot) -> float:
    """Return the time sqrt(l / g) [s] in which a pendulum of the robot's reach l swings by one radian; 0 without g."""
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    return float(np.sqrt(reach(robot.model) / gravity)) if gravity else 0.0


def _bounds(
    limits: Limits | None, quantity: str, joint: int, of_rows: tuple[float, float] | None
) -> tuple[float, float]:
    """Return the tightest bounds of a quantity of a joint: of the limits, and of rows."""
    lower, upper = (-np.inf, np.inf) if of_rows is None else of_rows
    sides = () if limits is None else limits.sides(quantity)
    low, high = (float(side[joint]) for side in sides) if sides else (-np.inf, np.inf)
    return max(lower, low), min(upper, high)


def _check_travel(phase: str, travel: _Travel, longest: float) -> None:
    """Refuse a travel that takes longer than the longest duration [s]."""
    least = travel.least_time(travel.acceleration)
    if least <= longest * (1 + ROUNDING):
        return
    enough, unit = travel.enough(longest), travel.unit
    instead = "" if enough is None else f", or an acceleration of at least {enough:.4g} {unit}/s^2"
    takes = f"it takes {least:.4g} s. Allow at least {least:.4g} s{instead}."
    if least == np.inf:
        takes = f"it keeps its speed. Allow {instead.removeprefix(', or ') or 'a higher limit'}."
    raise InputError(
        f"Phase {phase!r}: joint {travel.joint!r} must travel {abs(travel.last - travel.first):.4g} {unit} in "
        f"{longest:.4g} s, but with its acceleration limit of {travel.acceleration:.4g} {unit}/s^2 {takes}"
    )


def _check_braking(
    phase: str,
    joint: str,
    unit: str,
    place: str,
    moved: tuple[float, float],
    bounds: tuple[float, float],
    acceleration: float,
) -> None:
    """Refuse a speed that a joint cannot lose, or cannot have gained, inside its position limits."""
    at, speed = moved
    limit = bounds[1] if speed > 0.0 else bounds[0]
    if speed == 0.0 or not np.isfinite(limit):
        return
    room, needed = abs(limit - at), 0.5 * speed**2 / acceleration if acceleration > 0.0 else np.inf
    if needed <= room * (1 + ROUNDING):
        return
    raise InputError(
        f"Phase {phase!r}: at the {place}, joint {joint!r} is {room:.4g} {unit} from its position limit of "
        f"{limit:.4g} {unit} with a speed of {abs(speed):.4g} {unit}/s, and its acceleration limit of "
        f"{acceleration:.4g} {unit}/s^2 needs {needed:.4g} {unit}. Allow an acceleration of at least "
        f"{0.5 * speed**2 / max(room, 1e-300):.4g} {unit}/s^2, or move the limit."
    )
