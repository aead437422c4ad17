"""Timing of a path of straight lines in joint space: trapezoidal speeds that are reduced at corners.

On line k, q = q_k + s d_k, the limits of ``least_time`` bound s' and s''. At a corner the velocities d_k s' and
d_(k+1) s' must agree. A robot with acceleration a needs the time dv / a for a change of velocity dv, and deviates from
the corner by dv^2 / (8 a), which is at most ``ROUNDING``. A forward and a backward pass over the corners then give the
largest speeds that the accelerations permit. Source: Bobrow, Dubowsky and Gibson, IJRR 4 (1985), on straight lines.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.precision import DIFFERENCE, MET, SAME
from robotraj._util.values import dataclass
from robotraj.guess.least_time import LineLimits, Trapezoid

ROUNDING = 0.05
"""Largest deviation of a motion from a corner [rad, m]."""


@dataclass(frozen=True, eq=False)
class TimedPath:
    """A path and the trapezoid of every line of it.

    Attributes
    ----------
    corners : ndarray (m + 1, nv)
        Configurations, the ends included.
    laws : tuple of Trapezoid
        s(t) of every line, (m,).
    """

    corners: Array
    laws: tuple[Trapezoid, ...]

    @cached_property
    def ends(self) -> Array:
        """Times at which the lines end, from 0, (m + 1,) [s]."""
        return np.concatenate([[0.0], np.cumsum([law.duration for law in self.laws])])

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.ends[-1])

    def motion(self, fractions: Array) -> tuple[Array, Array, Array]:
        """Return q, dq/df and d^2q/df^2 (m, nv) at fractions f (m,) of the duration."""
        ends = self.ends
        t = np.asarray(fractions) * ends[-1]
        lines = np.clip(np.searchsorted(ends, t, side="right") - 1, 0, len(self.laws) - 1)
        q, rate, second = (np.empty((len(t), self.corners.shape[1])) for _ in range(3))
        for k, law in enumerate(self.laws):
            here = lines == k
            if not here.any():
                continue
            place, pace, change = law.motion(np.clip((t[here] - ends[k]) / law.duration, 0.0, 1.0))
            line, stretch = self.corners[k + 1] - self.corners[k], ends[-1] / law.duration
            q[here] = self.corners[k] + place[:, None] * line
            rate[here] = (stretch * pace)[:, None] * line
            second[here] = (stretch**2 * change)[:, None] * line
        return q, rate, second


def timed_path(limits: LineLimits, corners: Array) -> TimedPath | None:
    """Return the motion from rest to rest on a path (m, nv); None where no limit bounds the accelerations on a line."""
    steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    corners = corners[np.concatenate([[True], steps > MET])]
    if len(corners) < 2:
        return None
    lines = np.diff(corners, axis=0)
    lengths = np.linalg.norm(lines, axis=1)
    bounds = [limits.along(first, line) for first, line in zip(corners[:-1], lines, strict=True)]
    if not all(fastest > 0.0 and 0.0 < slope < np.inf for fastest, slope in bounds):
        return None
    # Speeds along the path [rad/s, m/s], the accelerations of its lines, and the largest squared speeds at corners.
    fastest, slopes = np.array(bounds).T * lengths
    squares = np.zeros(len(corners))
    directions = lines / lengths[:, None]
    for k in range(1, len(lines)):
        turn = directions[k] - directions[k - 1]
        widest = float(np.abs(turn).max())
        squares[k] = min(fastest[k - 1], fastest[k]) ** 2
        if widest > SAME:
            # A short line, since the robot stays at the corner.
            _, slope = limits.along(corners[k], DIFFERENCE * turn)
            squares[k] = min(squares[k], 8.0 * ROUNDING * DIFFERENCE * max(slope, 0.0) / widest)
    gains = 2.0 * slopes * lengths
    for k in range(len(lines)):
        squares[k + 1] = min(squares[k + 1], squares[k] + gains[k])
    for k in reversed(range(len(lines))):
        squares[k] = min(squares[k], squares[k + 1] + gains[k])
    speeds = np.sqrt(squares)
    laws = tuple(
        Trapezoid.of(
            fastest[k] / lengths[k], slopes[k] / lengths[k], speeds[k] / lengths[k], speeds[k + 1] / lengths[k]
        )
        for k in range(len(lines))
    )
    return TimedPath(corners, laws)
