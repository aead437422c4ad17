"""Set points of the motors over time for controllers: joints of one degree of freedom, angles in rad."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.solution.columns import values_of
from robotraj.solution.export.times import sample_times
from robotraj.solution.planned import Planned


@dataclass(frozen=True, eq=False)
class SetPoints:
    """Motions and torques of the motors.

    Attributes
    ----------
    joints, units : tuple of str
        The motors, in the order of ``robot.actuated``; ``"rad"`` or ``"m"``.
    t : ndarray (m,)
        Strictly ascending [s]; the first and the last are exactly those of the plan.
    q, v, a, tau : ndarray (m, joints)
        [rad, rad/s, rad/s^2, N m] or [m, m/s, m/s^2, N].
    """

    joints: tuple[str, ...]
    units: tuple[str, ...]
    t: Array
    q: Array
    v: Array
    a: Array
    tau: Array


def set_points(solution: Planned, rate: float) -> SetPoints:
    """Sample a plan of one robot at a rate [Hz].

    Raises
    ------
    InputError
        The plan moves a System or several robots, or the rate is not above 0.
    """
    robot = solution.phases[0].phase.robot
    if robot is None or any(part.phase.robot is not robot for part in solution.phases):
        raise InputError("Set points are those of one robot's motors; export a System by to_csv or to_json.")
    start = solution.phases[0].t0
    times = sample_times(start, start + solution.duration, 0, rate)
    if rate * solution.duration < 1.0:
        raise InputError(
            f"rate={rate:g} is one set point in {1.0 / rate:g} s, and the motion takes {solution.duration:.4g} s. The "
            "unit is Hz: a period of 1 ms is rate=1000."
        )
    starts = np.array([part.t0 for part in solution.phases])
    owner = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(starts) - 1)
    found = {kind: np.empty((len(times), len(robot.actuated))) for kind in ("q", "v", "a", "tau")}
    for i, part in enumerate(solution.phases):
        own = owner == i
        if own.any():
            values = values_of(part, times[own])
            for kind, array in found.items():
                array[own] = np.stack([values[f"{kind}.{joint}"] for joint in robot.actuated], axis=1)
    units = dict(zip(robot.velocity_names, robot.units, strict=True))
    return SetPoints(robot.actuated, tuple(units[joint] for joint in robot.actuated), times, **found)
