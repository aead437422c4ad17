"""Overlaps of the robot's own shapes along a motion, found by halving the time.

Two shapes approach each other at a speed of at most L = factors @ abs(v) [m/s]. A piece of the motion of length h is
free of overlaps where they are further apart than L h / 2 in its middle. Other pieces are divided, and shapes are
compared at least every ``RESOLUTION`` where they stay near. Balls come first, then convex hulls, then the shapes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from robotraj._util.arrays import Array, Indices
from robotraj._util.precision import SAMPLES
from robotraj._util.values import dataclass
from robotraj.robot.collision.own_body import OwnBody
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import Placed, depth, distance, hull_distance, one_inside, touch
from robotraj.robot.robot import Robot

Motion = Callable[[Array], Array]
"""From times (m,) [s] to configurations (m, nq)."""

RESOLUTION = 1e-3
"""Longest time between two comparisons of shapes that are near each other [s]."""
PIECES = 32
"""Largest number of pieces with a bound on the speeds of their own."""
CLOSE = 5e-3
"""Margin up to which coal compares shapes [m]."""
MOST_PARTS = 32
"""Largest number of parts into which a piece is divided."""
HALVINGS = 10
"""Number of bisections between a configuration that overlaps and a free one."""
DEPTHS = 9
"""Number of times of an overlap at which its depth is computed."""


@dataclass(frozen=True, eq=False)
class Near:
    """A pair of shapes that overlaps or comes near along a motion.

    Attributes
    ----------
    pair : int
        In ``OwnBody.pairs``.
    times : ndarray (k,)
        Times at which the pair overlaps, or else the times of the finest pieces [s].
    overlaps : bool
    """

    pair: int
    times: Array
    overlaps: bool


def near_pairs(
    robot: Robot,
    body: OwnBody,
    motion: Motion,
    knots: Array,
    speeds: Array,
    clock: Callable[[], None] = lambda: None,
    every: bool = True,
    apart: float = 0.0,
) -> list[Near]:
    """Return the pairs that overlap along a motion, and those that stay near.

    With ``apart``, pairs count as overlapping where they are not proved to be that far apart at every time: their
    distance may be larger than ``apart`` by what they approach each other in half of ``RESOLUTION``.

    Parameters
    ----------
    robot : Robot
    body : OwnBody
    motion : callable
    knots : ndarray (K + 1,)
        Ends of the intervals [s].
    speeds : ndarray (K, nv)
        Bounds on the joint speeds in each interval.
    clock : callable
        Called once a round; it raises an error where no time is left.
    every : bool
        Whether all times of an overlap are found, not only some.
    apart : float
        Distance [m].
    """
    if not len(body.pairs):
        return []
    starts = np.unique(np.linspace(0, len(knots) - 1, PIECES + 1).astype(int))[:-1]
    bounds = np.maximum.reduceat(speeds, starts, axis=0) @ body.factors.T
    edges = np.append(knots[starts], knots[-1])
    count = len(body.pairs)
    piece = np.repeat(np.arange(len(starts)), count)
    pair = np.tile(np.arange(count), len(starts))
    at, half = 0.5 * (edges[:-1] + edges[1:])[piece], 0.5 * np.diff(edges)[piece]
    hits: dict[int, list[float]] = {}
    deepest: dict[int, tuple[float, list[float]]] = {}
    first = True
    while at.size:
        clock()
        finest = half <= 0.5 * RESOLUTION
        margins = apart + np.where(finest & (apart == 0.0), 0.0, bounds[piece, pair] * half)
        parts = _parts(robot, body, motion, pair, at, margins)
        open_ = parts > 0
        for k in np.flatnonzero(open_ | finest).tolist():
            own, width = int(pair[k]), float(half[k])
            known = deepest.setdefault(own, (width, []))
            if width < known[0]:
                known = deepest[own] = width, []
            if width == known[0]:
                known[1].append(float(at[k]))
        for k in np.flatnonzero(open_ & finest).tolist():
            hits.setdefault(int(pair[k]), []).append(float(at[k]))
        open_ &= ~finest
        if first and not every:
            hit = _parts(robot, body, motion, pair[open_], at[open_], np.zeros(int(open_.sum()))) > 0
            for own, time in zip(pair[open_][hit].tolist(), at[open_][hit].tolist(), strict=True):
                hits.setdefault(own, []).append(time)
            open_ &= ~np.isin(pair, list(hits))
        first = False
        parts = np.minimum(parts, np.ceil(half / (0.5 * RESOLUTION)).astype(int))[open_]
        piece, pair, half, at = (np.repeat(each[open_], parts) for each in (piece, pair, half, at))
        which, parts = np.arange(len(at)) - np.repeat(np.cumsum(parts) - parts, parts), np.repeat(parts, parts)
        at += half * ((2 * which + 1) / parts - 1.0)
        half = half / parts
    for own, t in _inside(robot, body, motion, knots, np.setdiff1d(np.arange(count), list(hits))):
        hits.setdefault(own, []).append(t)
    found = [Near(own, np.sort(times), True) for own, times in hits.items()]
    return found + [Near(own, np.sort(t), False) for own, (_, t) in deepest.items() if own not in hits]


def pairs_within(robot: Robot, body: OwnBody, q: Array, margin: float = 0.0) -> npt.NDArray[np.bool_]:
    """Whether each pair is within a margin [m] in each configuration (m, nq), (m, pairs); with margin 0, overlaps.

    Of meshes, the surfaces are compared up to a margin of ``CLOSE``, and the convex hulls beyond it.
    """
    count, pairs = len(q), len(body.pairs)
    at, pair = np.repeat(np.arange(count), pairs), np.tile(np.arange(pairs), count)
    return _within(robot, body, q, pair, at, margin).reshape(count, pairs)


def pairs_along(robot: Robot, body: OwnBody, motion: Motion, margin: float = 0.0) -> list[int]:
    """Return the pairs that come within a margin [m] at equal steps of a motion over fractions from 0 to 1."""
    near = pairs_within(robot, body, motion(np.linspace(0.0, 1.0, SAMPLES)), margin)
    found: list[int] = np.flatnonzero(near.any(axis=0)).tolist()
    return found


def freed(robot: Robot, body: OwnBody, pair: int, q: Array, free: Array, margin: float) -> Array:
    """Return configurations (m, nq), moved towards others until a pair is a margin [m] apart.

    Each moves on the straight line to its own one of ``free`` (m, nq); all the way where the pair is near there too.
    """
    near = np.flatnonzero(_within(robot, body, q, np.full(len(q), pair), np.arange(len(q)), margin))
    low, high = np.zeros(len(near)), np.ones(len(near))
    for _ in range(HALVINGS):
        share = 0.5 * (low + high)
        tried = q[near] + share[:, None] * (free[near] - q[near])
        inside = _within(robot, body, tried, np.full(len(near), pair), np.arange(len(near)), margin)
        low, high = np.where(inside, share, low), np.where(inside, high, share)
    moved = q.copy()
    moved[near] += high[:, None] * (free[near] - q[near])
    return moved


def _within(robot: Robot, body: OwnBody, q: Array, pair: Indices, at: Indices, margin: float) -> npt.NDArray[np.bool_]:
    """Whether pairs (n,) are within a margin in configurations ``at`` (n,) of (m, nq)."""
    if not len(pair):
        return np.zeros(0, dtype=bool)
    found = _parts(robot, body, lambda times: q[times.astype(int)], pair, at.astype(float), np.full(len(at), margin))
    return np.asarray(found > 0)


def deepest_overlap(robot: Robot, body: OwnBody, motion: Motion, near: Near) -> tuple[float, float]:
    """Return the largest depth [m] of a pair at ``DEPTHS`` times of its overlap, and its time [s]."""
    times = near.times[np.unique(np.linspace(0, len(near.times) - 1, DEPTHS).astype(int))]
    joints = placements(robot, motion(times))
    first, second = (body.placed_along(shape, *joints) for shape in body.pairs[near.pair].tolist())
    depths = list(map(depth, first, second))
    most = int(np.argmax(depths))
    return depths[most], float(times[most])


def least_distance(robot: Robot, body: OwnBody, motion: Motion, near: Near) -> tuple[float, float]:
    """Return the least distance [m] of a pair that does not overlap at ``DEPTHS`` times, and its time [s]."""
    times = near.times[np.unique(np.linspace(0, len(near.times) - 1, DEPTHS).astype(int))]
    joints = placements(robot, motion(times))
    first, second = (body.placed_along(shape, *joints) for shape in body.pairs[near.pair].tolist())
    apart = list(map(distance, first, second))
    least = int(np.argmin(apart))
    return apart[least], float(times[least])


def _parts(robot: Robot, body: OwnBody, motion: Motion, pair: Indices, at: Array, margins: Array) -> Indices:
    """Return the number of parts into which to divide the piece around each time, 0 where a pair is beyond its margin.

    With margin 0, return 1 where the pair overlaps.
    """
    times, which = np.unique(at, return_inverse=True)
    rotations, origins = placements(robot, motion(times))
    near = body.near_by_balls(pair, which, rotations, origins, margins)
    parts = np.zeros(len(pair), dtype=int)
    # Most of the time is that of Python, so each shape is placed once at a time.
    shapes = len(body.solids)
    used, numbers = np.unique(which[near, None] * shapes + body.pairs[pair[near]], return_inverse=True)
    places: list[list[int]] = numbers.reshape(-1, 2).tolist()
    when, shape = used // shapes, used % shapes
    joint = body.joint[shape]
    turns = rotations[when, joint] @ body.rotation[shape]
    positions = np.einsum("nij,nj->ni", rotations[when, joint], body.position[shape]) + origins[when, joint]
    placed = [Placed(body.solids[k], *place) for k, *place in zip(shape.tolist(), turns, positions, strict=True)]
    for k, (a, b), margin in zip(near.tolist(), places, margins[near].tolist(), strict=True):
        apart = hull_distance(placed[a], placed[b])
        if apart > margin:
            continue
        # Meshes within a large margin of each other take coal long.
        if margin <= CLOSE and apart <= 0.0 and not touch(placed[a], placed[b], margin):
            continue
        parts[k] = 1 if margin == 0.0 else min(max(int(np.ceil(margin / max(apart, CLOSE))), 2), MOST_PARTS)
    return parts


def _inside(robot: Robot, body: OwnBody, motion: Motion, knots: Array, pairs: Indices) -> list[tuple[int, float]]:
    """Return the pairs of which one shape lies inside the other, with a time.

    That cannot change unless the surfaces cross, so three times suffice.
    """
    times = np.array([knots[0], 0.5 * (knots[0] + knots[-1]), knots[-1]])
    rotations, origins = placements(robot, motion(times))
    which, pair = np.repeat(np.arange(len(times)), len(pairs)), np.tile(pairs, len(times))
    found = []
    for k in body.near_by_balls(pair, which, rotations, origins).tolist():
        time, own = int(which[k]), int(pair[k])
        first, second = (body.placed(shape, rotations[time], origins[time]) for shape in body.pairs[own].tolist())
        if one_inside(first, second):
            found.append((own, float(times[time])))
    return found
