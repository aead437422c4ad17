"""The attitude of a root that turns once over: at a constant rate in flight, accelerated and braked in the stances.

Without contacts the angular momentum is constant, so that a robot turns at a nearly constant rate w. The stances before
and after the flight, from a to b, accelerate and brake the rotation, each in the time e:

    angle(t) = w (t - a + e)^2 / (2 e)   for  a - e <= t <= a,      w (e / 2 + t - a)   for  a <= t <= (a + b) / 2,

with w = 2 pi / (b - a + e). After the middle, angle(t) = 2 pi - angle(a + b - t).
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.guess.legs.schedule import Schedule
from robotraj.problem.constraints.bounds import as_bounds
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.chart import PITCH
from robotraj.robot.root import PLANAR, QUATERNION
from robotraj.robot.tangent import product

EASE = 0.25
"""Time in which the stances accelerate and brake the rotation, relative to that of the flight."""
PLANAR_PITCH = PLANAR.index("root_pitch")
"""Index of a planar root's pitch in q."""


@dataclass(frozen=True, eq=False)
class Somersault:
    """One turn of the root.

    Attributes
    ----------
    axis : ndarray (3,) or (1,)
        Unit vector in world axes, about which the root turns counter-clockwise; for a planar root its y.
    start, end : float
        Takeoff and landing [s].
    """

    axis: Array
    start: float
    end: float

    def angle(self, t: float) -> float:
        """Return the angle at a time [s], from 0 to 2 pi [rad]."""
        middle, span = 0.5 * (self.start + self.end), self.end - self.start
        if t > middle:
            return 2.0 * np.pi - self.angle(2.0 * middle - t)
        ease = EASE * span
        eased, flown = max(min(t, self.start) - self.start + ease, 0.0), max(t - self.start, 0.0)
        return float(2.0 * np.pi / (span + ease) * (eased**2 / (2.0 * ease) + flown))

    def turned(self, q: Array, t: float) -> Array:
        """Return a configuration (nq,) whose root is turned about its origin by the angle of a time [s]."""
        q, angle = np.array(q), self.angle(t)
        if len(self.axis) == 1:
            q[PLANAR_PITCH] += self.axis[0] * angle
        else:
            turn = np.append(np.sin(0.5 * angle) * self.axis, np.cos(0.5 * angle))
            q[QUATERNION] = product(turn, q[QUATERNION])
        return q


def somersault_of(problem: Problem, schedule: Schedule, home: Array) -> Somersault | None:
    """Return the turn of a motion that ends one turn after the attitude in which it starts; None for others.

    A planar root ends with a pitch 2 pi away, a floating one with the negative quaternion. The axis is then halfway
    between the bounds of the quaternion's vector in flight, or that of pitch. The turn is in the longest flight.
    """
    flights = [i for i, held in enumerate(schedule.held) if not held]
    first, last = home, problem.phases[-1].end_bounds.lower[: len(home)]
    if not flights or schedule.repeat is not None:
        return None
    longest = max(flights, key=lambda i: schedule.times[i + 1] - schedule.times[i])
    span = schedule.times[longest], schedule.times[longest + 1]
    robot = problem.phases[0].robot
    if robot is not None and robot.root == "planar":
        turns = (last[PLANAR_PITCH] - first[PLANAR_PITCH]) / (2.0 * np.pi)
        return Somersault(np.array([np.sign(turns)]), *span) if np.round(abs(turns)) == 1.0 else None
    if not first[QUATERNION] @ last[QUATERNION] < 0.0:
        return None
    return Somersault(_axis(problem.phases[longest]), *span)


def _axis(phase: Phase) -> Array:
    """Return the axis about which the bounds of a floating root's quaternion let it turn, (3,)."""
    bounds = as_bounds(dict(phase.states), [state.name for state in phase.dae.states], "states", "state")
    lower, upper = (side[QUATERNION][:3] for side in bounds)
    axis = lower + upper if np.isfinite([lower, upper]).all() else np.zeros(3)
    size = float(np.linalg.norm(axis))
    return np.asarray(axis / size) if size > 0.0 else PITCH
