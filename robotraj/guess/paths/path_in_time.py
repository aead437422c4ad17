"""Timing of a path among moving obstacles: forward at full speed, waiting, or backward.

A path is divided into steps of equal time of its quickest motion. In the plane of steps and times a place is free if no
moving obstacle is near. From one time to the next the robot moves one step forward, stays, or moves one step backward.
A search finds the first time at which it can be at the end.
Source: Kant and Zucker, Toward Efficient Trajectory Planning: The Path-Velocity Decomposition, IJRR 5 (1986).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from robotraj._util.arrays import Array, Mask
from robotraj._util.precision import SAME
from robotraj._util.values import dataclass

Free = Callable[[Array, Array], Mask]
"""Function of configurations (n, nq) and times (m,) [s]: whether the robot is free of moving obstacles, (n, m)."""

STEPS = 40
"""Steps of a path."""
LONGEST = 64
"""Largest duration that is tried, relative to the quickest one."""
WINDOW = 7
"""Number of steps over which motions are averaged, since a robot does not start, stop or turn instantly."""


class TimedMotion(Protocol):
    """A motion with a duration [s] and q, dq/df and d^2q/df^2 (m, nv) at fractions f (m,) of it."""

    @property
    def duration(self) -> float:
        """Duration [s]."""

    def motion(self, fractions: Array) -> tuple[Array, Array, Array]:
        """Return q and its rates."""


@dataclass(frozen=True, eq=False)
class PathInTime:
    """A motion along a path that may wait or reverse.

    Attributes
    ----------
    path : TimedMotion
        The quickest motion.
    places : ndarray (m,)
        Fractions of the path at evenly spaced times.
    duration : float
        Duration [s].
    """

    path: TimedMotion
    places: Array
    duration: float

    def motion(self, fractions: Array) -> tuple[Array, Array, Array]:
        """Return q, dq/df and d^2q/df^2 (m, nv) at fractions f (m,) of the duration."""
        grid = np.linspace(0.0, 1.0, len(self.places))
        f = np.asarray(fractions)
        places = np.interp(f, grid, self.places)
        speeds = np.interp(f, grid, np.gradient(self.places, grid))
        q, rate, second = self.path.motion(places)
        return q, speeds[:, None] * rate, speeds[:, None] ** 2 * second


def in_time(path: TimedMotion, free: Free, bounds: tuple[float, float]) -> TimedMotion | None:
    """Return the quickest motion along a path without a collision, or None.

    Parameters
    ----------
    path : TimedMotion
    free : callable
    bounds : (float, float)
        Bounds of the duration [s].
    """
    step = path.duration / STEPS
    q = path.motion(np.linspace(0.0, 1.0, STEPS + 1))[0]
    least = int(np.ceil(bounds[0] / step - SAME))
    most = max(min(LONGEST * STEPS, int(np.floor(bounds[1] / step + SAME))), least)
    reached = np.zeros((1, STEPS + 1), dtype=bool)
    reached[0, 0] = True
    while len(reached) <= most:
        begin = len(reached)
        times = np.arange(begin, min(begin + STEPS, most + 1), dtype=np.float64) * step
        rows = free(q, times).T
        more = np.empty_like(rows)
        before = reached[-1]
        for k, row in enumerate(rows):
            near = before.copy()
            near[1:] |= before[:-1]
            near[:-1] |= before[1:]
            more[k] = before = near & row
        reached = np.concatenate([reached, more])
        arrived = np.flatnonzero(reached[least:, -1]) + least
        if arrived.size:
            return _along(path, reached[: int(arrived[0]) + 1], step)
        if not before.any():
            return None
    return None


def _along(path: TimedMotion, reached: Mask, step: float) -> TimedMotion:
    """Return the motion that ends at the last time, by a backward search that prefers forward steps."""
    places = [STEPS]
    for row in reached[-2::-1]:
        at = places[-1]
        places.append(next(k for k in (at - 1, at, at + 1) if 0 <= k <= STEPS and row[k]))
    if len(places) == STEPS + 1:
        return path
    ahead = np.array(places[::-1], dtype=float) / STEPS
    padded = np.pad(ahead, WINDOW // 2, mode="edge")
    smooth = np.convolve(padded, np.full(WINDOW, 1.0 / WINDOW), mode="valid")
    smooth[[0, -1]] = ahead[[0, -1]]
    return PathInTime(path, smooth, step * (len(ahead) - 1))
