"""Least time of a straight line in joint space: a trapezoid of speed over time.

On the line q = q_0 + s (q_1 - q_0) from s = 0 to 1, with d = q_1 - q_0, the inverse dynamics are linear in s'':

    tau = M(q) d s'' + (C(q, d) d) s'^2 + g(q).

The middle term is neglected. Then every torque limits s'' at every place, |s''| <= min_j r_j / |(M d)_j|. Here r_j is
the lesser distance of g_j, with Coulomb friction, from the two torque limits. The limits of accelerations and speeds
give |s''| <= min_j a_j / |d_j| and s' <= min_j v_j / |d_j|. Let k be the limit of s''. The motion of least time then
has a trapezoidal speed, or a triangular one if it does not reach the speed limit.

Source: Lynch and Park, Modern Robotics (2017), sections 9.2 (straight paths, trapezoidal time scaling) and 9.4 (limits
of s'' along a path).
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.precision import SAME
from robotraj._util.values import dataclass
from robotraj.problem.phase import Phase
from robotraj.robot.robot import Robot

PLACES = 9
"""Number of points of the line at which torques are evaluated."""


@dataclass(frozen=True)
class Trapezoid:
    """The motion of least time from s = 0 to 1 with abs(s'') <= k: speed rises, stays at its peak, and falls.

    Attributes
    ----------
    first, peak, last : float
        s' at the start, between the ramps and at the end [1/s].
    slope : float
        k [1/s^2].
    """

    first: float
    peak: float
    last: float
    slope: float

    @classmethod
    def of(cls, fastest: float, slope: float, first: float = 0.0, last: float = 0.0) -> Trapezoid:
        """Compute the peak p: p^2 = k + (s'_0^2 + s'_1^2) / 2, at most the speed limit.

        Parameters
        ----------
        fastest : float
            Largest s' [1/s]; may be infinite.
        slope : float
            k [1/s^2], positive and finite.
        first, last : float
            Speeds at the ends [1/s]; they are reduced to what the length and the speed limit allow.
        """
        first, last = np.clip([first, last], 0.0, fastest)
        first, last = min(first, np.sqrt(last**2 + 2 * slope)), min(last, np.sqrt(first**2 + 2 * slope))
        peak = min(fastest, np.sqrt(slope + 0.5 * (first**2 + last**2)))
        return cls(float(first), float(peak), float(last), slope)

    @cached_property
    def times(self) -> Array:
        """Times of the start, the end of the rise, the start of the fall and the end, (4,) [s]."""
        rise, fall = (self.peak - self.first) / self.slope, (self.peak - self.last) / self.slope
        ramps = 0.5 * (rise * (self.first + self.peak) + fall * (self.peak + self.last))
        return np.cumsum([0.0, rise, max(0.0, 1.0 - ramps) / self.peak, fall])

    @property
    def duration(self) -> float:
        """Least time [s]: 1 / p + p / k from rest to rest."""
        return float(self.times[-1])

    def motion(self, fractions: Array) -> tuple[Array, Array, Array]:
        """Return s, ds/df and d^2s/df^2 (m,) at fractions f (m,) of the duration."""
        times, speeds = self.times, np.array([self.first, self.peak, self.peak, self.last])
        t = np.asarray(fractions) * times[-1]
        piece = np.clip(np.searchsorted(times[1:-1], t), 0, 2)
        slopes = np.array([self.slope, 0.0, -self.slope])[piece]
        elapsed = t - times[piece]
        passed = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(times) * (speeds[:-1] + speeds[1:]))])
        place = passed[piece] + elapsed * (speeds[piece] + 0.5 * slopes * elapsed)
        return place, (speeds[piece] + slopes * elapsed) * times[-1], slopes * times[-1] ** 2


def fastest_line(phase: Phase, first: Array, last: Array) -> Trapezoid | None:
    """Return the fastest motion on the straight line between two states.

    The speed, acceleration and torque limits of the phase bound it.

    Parameters
    ----------
    phase : Phase
    first, last : ndarray (nx,)
        States at the ends of the line.

    Returns
    -------
    Trapezoid or None
        None if the accelerations have no known bound. This is so for joints without motors or limits, a moving root,
        contacts, equal ends, and motors too weak to hold the robot on the line.
    """
    limits = LineLimits.of(phase)
    if limits is None:
        return None
    n = limits.robot.nv
    line = last[:n] - first[:n]
    fastest, slope = limits.along(first[:n], line)
    if not (fastest > 0 and 0 < slope < np.inf):
        return None
    along = line / (line @ line)
    return Trapezoid.of(fastest, slope, float(along @ first[n : 2 * n]), float(along @ last[n : 2 * n]))


@dataclass(frozen=True, eq=False)
class LineLimits:
    """Limits (nv,) of a robot with a motor at every joint that hold throughout a phase, infinite where there are none.

    Attributes
    ----------
    robot : Robot
    speeds, accelerations, torques : pair of ndarray
        Lower and upper limits [rad/s, m/s; rad/s^2, m/s^2; N m, N].
    """

    robot: Robot
    speeds: tuple[Array, Array]
    accelerations: tuple[Array, Array]
    torques: tuple[Array, Array]

    @classmethod
    def of(cls, phase: Phase) -> LineLimits | None:
        """Return the limits of a phase; None for joints without motors, a moving root, contacts, systems and paths."""
        robot = phase.state_robot
        if robot is None or robot.root != "fixed" or robot.nu < robot.nv or phase.bound_contacts:
            return None
        limits = phase.rows.limits()

        def pair(quantity: str) -> tuple[Array, Array]:
            bounds = [limits.get(f"{quantity}.{name}", (-np.inf, np.inf)) for name in robot.velocity_names]
            lower, upper = np.reshape(bounds, (-1, 2)).T
            return lower, upper

        return cls(robot, pair("v"), pair("a"), pair("tau"))

    def along(self, first: Array, line: Array) -> tuple[float, float]:
        """Return the largest s' [1/s] and abs(s'') [1/s^2] on q = first + s line, s from 0 to 1.

        The second is 0 or less if the motors cannot hold the robot on the line, and infinite without limits. Both are 0
        for a line of length 0.
        """
        moved = np.abs(line) > SAME * np.max(np.abs([first, first + line]), initial=0.0)
        if not moved.any():
            return 0.0, 0.0
        lower, upper = self.speeds
        fastest = float(np.min(np.where(line > 0, upper, -lower)[moved] / np.abs(line[moved])))
        lower, upper = self.accelerations
        slope = float(np.min(np.minimum(upper, -lower)[moved] / np.abs(line[moved])))
        lower, upper = self.torques
        model, data, zero = self.robot.model, self.robot.model.createData(), np.zeros(len(line))
        places = first + np.linspace(0.0, 1.0, PLACES)[:, None] * line
        # rnea returns a view of data, which the next call overwrites.
        gravity = np.array([pin.rnea(model, data, q, zero, zero).copy() for q in places])
        inertia = np.abs(np.array([pin.rnea(model, data, q, zero, line).copy() for q in places]) - gravity)
        springs = np.array([self.robot.resistance(q, zero) for q in places])
        held = gravity + springs + self.robot.friction * np.sign(line)
        reserve = np.minimum(upper - held, held - lower)
        least = SAME * np.max(inertia)
        loaded = (inertia > least) | (reserve < 0)
        slopes = reserve[loaded] / np.maximum(inertia[loaded], max(least, np.finfo(float).tiny))
        return fastest, min(slope, float(np.min(slopes, initial=np.inf)))
