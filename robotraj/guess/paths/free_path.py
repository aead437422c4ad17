"""Paths through free configurations near a known path that is not free, by a random search."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.precision import ROUND_OFF

Free = Callable[[Array], NDArray[np.bool_]]
"""From configurations (m, nq) to whether each is free."""

STRIDE = 0.6
"""Longest motion of one step of a tree [rad, m]."""
STEP = 0.04
"""Distance of the configurations on it that are compared [rad, m]."""
TRIES = 400
"""Largest number of random configurations."""
SHORTCUTS = 60
"""Number of shortcuts that are tried."""
AROUND = 0.7
"""Largest standard deviation of random configurations around the known ones, of which half are [rad, m]."""


def free_path(free: Free, known: Array, lower: Array, upper: Array, tries: int = TRIES, seed: int = 0) -> Array | None:
    """Return the corners (m, nq) of a free path between the ends of a known one, shortened; None if none was found.

    Trees of straight motions grow from both ends until they meet. Source: Kuffner and LaValle, RRT-Connect, ICRA 2000.

    Parameters
    ----------
    free : callable
        Compares configurations.
    known : ndarray (n, nq)
        Configurations, of which the first and the last are free.
    lower, upper : ndarray (nq,)
        Bounds of the positions; infinite ones of joints without limits.
    tries : int
        Largest number of random configurations.
    seed : int
    """
    rng = np.random.default_rng(seed)
    low, high = np.maximum(lower, known.min(axis=0) - np.pi), np.minimum(upper, known.max(axis=0) + np.pi)
    trees = _Tree(known[0]), _Tree(known[-1])
    for number in range(tries):
        grown, other = trees if number % 2 == 0 else trees[::-1]
        if number % 4 < 2:
            aim = rng.uniform(low, high)
        else:
            aim = known[rng.integers(len(known))] + AROUND * rng.random() * rng.normal(size=known.shape[1])
        reached = grown.extend(np.clip(aim, low, high), free)
        if reached is None:
            continue
        goal = grown.points[reached]
        while (met := other.extend(goal, free)) is not None:
            if np.array_equal(other.points[met], goal):
                ways = grown.way(reached), other.way(met)
                one, two = ways if grown is trees[0] else ways[::-1]
                return _shortened(np.array([*one[::-1], *two[1:]]), free, rng)
    return None


class _Tree:
    def __init__(self, root: Array) -> None:
        self.points: list[Array] = [root]
        self.parents: list[int] = [-1]

    def extend(self, aim: Array, free: Free) -> int | None:
        """Add the configuration one stride towards an aim; return its number, None where the motion is not free."""
        near = int(np.argmin(np.linalg.norm(np.array(self.points) - aim, axis=1)))
        way = aim - self.points[near]
        length = float(np.linalg.norm(way))
        if length == 0.0:
            return near
        point = aim if length <= STRIDE else self.points[near] + STRIDE / length * way
        if not _is_free(free, self.points[near], point):
            return None
        self.points.append(point)
        self.parents.append(near)
        return len(self.points) - 1

    def way(self, number: int) -> list[Array]:
        """Return the configurations from one to the root."""
        found = []
        while number >= 0:
            found.append(self.points[number])
            number = self.parents[number]
        return found


def _is_free(free: Free, first: Array, last: Array) -> bool:
    count = int(np.ceil(np.linalg.norm(last - first) / STEP)) + 1
    shares = np.linspace(0.0, 1.0, count)[:, None]
    # A motion that is not free mostly overlaps at one of a few configurations.
    coarse = shares[-1 :: -max(count // 4, 1)]
    return all(bool(free(first + part * (last - first)).all()) for part in (coarse, shares))


def _shortened(corners: Array, free: Free, rng: np.random.Generator) -> Array:
    """Replace parts of a path by straight motions, where these are free."""
    for _ in range(SHORTCUTS):
        lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        at = np.sort(rng.uniform(0.0, ends[-1], 2))
        (i, j), points = np.searchsorted(ends, at, side="right") - 1, []
        for k, place in zip((i, j), at, strict=True):
            k = min(int(k), len(lengths) - 1)
            points.append(corners[k] + (place - ends[k]) / max(lengths[k], ROUND_OFF) * (corners[k + 1] - corners[k]))
        if i != j and _is_free(free, points[0], points[1]):
            corners = np.array([*corners[: i + 1], *points, *corners[j + 1 :]])
    return corners
