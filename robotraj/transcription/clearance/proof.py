"""Proof of distances between the collocation points, or the places and amounts of their shortfalls.

The distance d of a pair changes at a rate of at most L = sum_j lever_j max abs(v_j) [m/s]
(``ClearancePairs.speed_factors``), plus the speed of a moving obstacle. The speeds are bounded on each interval by the
Bernstein coefficients of their polynomials. With d at the middle of a piece of length h, the distance is at least
d - L h / 2 on the piece. A piece whose bound is below the margin, and below the least distance of this pair that is
known, is halved, until all are proved or d itself is below.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.values import dataclass
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.interval_limits.bernstein_bounds import coefficients

if TYPE_CHECKING:
    from robotraj.native._native import SphereTree


HALVINGS = 16
"""Number of halvings after which a piece that is not proved counts as a shortfall."""
COARSE = 8
"""Number of halvings after which a pair below the margin is divided no further."""


@dataclass(frozen=True, eq=False)
class Shortfalls:
    """Distances that are not proved, each interval and pair once.

    Attributes
    ----------
    intervals, pairs : ndarray of int (k,)
    times : ndarray (k,)
        Time of the least evaluated distance [s].
    distances : ndarray (k,)
        The least evaluated distance, or its lower bound where only that is below the margin [m].
    least : float
        Least distance of all pairs at all evaluations [m]; infinite without pairs.
    nearest : (int, float)
        Pair and time [s] of ``least``; pair -1 without pairs.
    """

    intervals: Indices
    pairs: Indices
    times: Array
    distances: Array
    least: float
    nearest: tuple[int, float]


def shortfalls(pairs: ClearancePairs, x: PiecewisePolynomial) -> Shortfalls:
    """Prove the distances of pairs along the states of a motion; return those that are not proved."""
    nothing = np.zeros(0, dtype=int)
    if not len(pairs):
        return Shortfalls(nothing, nothing, np.zeros(0), np.zeros(0), np.inf, (-1, 0.0))
    if pairs.tree is not None:
        return _compiled(pairs, pairs.tree, x)
    nq = pairs.robot.nq
    breaks = x.breaks
    lengths = np.diff(breaks)
    bounds = _speed_bounds(pairs, x)
    half = 0.5 * lengths
    middle = breaks[:-1] + half
    distances = pairs.distances(x(middle)[:, :nq], middle)
    # A bound that is NaN proves nothing.
    interval, pair = np.nonzero(~(distances - bounds * half[:, None] >= pairs.margin))
    at, found = middle[interval], distances[interval, pair]
    width = half[interval]
    best = np.unravel_index(int(np.argmin(distances)), distances.shape)
    least, nearest = float(distances[best]), (int(best[1]), float(middle[best[0]]))
    worst, when = np.full(distances.shape, np.inf), np.zeros(distances.shape)
    for depth in range(HALVINGS + 1):
        if not interval.size:
            break
        k = int(np.argmin(found))
        if found[k] < least:
            least, nearest = float(found[k]), (int(pair[k]), float(at[k]))
        last = depth == HALVINGS
        reached = found - bounds[interval, pair] * width
        bound = np.nan_to_num(reached if last else found, nan=-np.inf)
        lower = (bound < pairs.margin) & (bound < worst[interval, pair])
        # Of several pieces of one interval the assignment keeps the last one, which has the least bound.
        order = np.flatnonzero(lower)[np.argsort(-bound[lower], kind="stable")]
        worst[interval[order], pair[order]], when[interval[order], pair[order]] = bound[order], at[order]
        if last:
            break
        known = worst[interval, pair]
        open_ = ~(reached >= np.minimum(pairs.margin, known))
        if depth >= COARSE:
            open_ &= known == np.inf
        interval, pair = np.repeat(interval[open_], 2), np.repeat(pair[open_], 2)
        width, at = np.repeat(0.5 * width[open_], 2), np.repeat(at[open_], 2)
        at = at + width * np.tile([-1.0, 1.0], len(at) // 2)
        if interval.size:
            found = pairs.distances_of(pair, x(at, interval)[:, :nq], at)
    interval, pair = np.nonzero(worst < np.inf)
    return Shortfalls(interval, pair, when[interval, pair], worst[interval, pair], least, nearest)


def _compiled(pairs: ClearancePairs, tree: SphereTree, x: PiecewisePolynomial) -> Shortfalls:
    """Prove distances in the compiled module, whose bounds follow the motion of each sphere."""
    nq = pairs.robot.nq
    rows = [coefficients(sites, values[:, :nq]) for sites, values in zip(x.sites, x.values, strict=True)]
    counts = np.array([len(each) for each in rows], dtype=np.int64)
    places, amounts = tree.shortfalls(np.concatenate(rows).ravel(), counts, pairs.margin)
    intervals, first, second, both = places.reshape(-1, 4).T
    taus, distances = amounts.reshape(-1, 2).T
    times = x.breaks[intervals] + taus * np.diff(x.breaks)[intervals]
    named = zip(first.tolist(), second.tolist(), both.tolist(), strict=True)
    found = np.array([pairs.numbers.get((a, b, bool(c)), -1) for a, b, c in named], dtype=int)
    return Shortfalls(
        intervals[:-1], found[:-1], times[:-1], distances[:-1], float(distances[-1]), (int(found[-1]), float(times[-1]))
    )


def _speed_bounds(pairs: ClearancePairs, x: PiecewisePolynomial) -> Array:
    """Return bounds (K, n) on the rate of each distance on each interval [m/s]."""
    rates = _rates(pairs, x)
    speeds = np.array(
        [np.abs(coefficients(rates.sites[k], rates.values[k])).max(axis=0) for k in range(len(rates.values))]
    )
    bounds = speeds @ pairs.speed_factors.T
    for number, obstacle in enumerate(pairs.obstacles):
        if obstacle.moves:
            own = np.flatnonzero(pairs.second[: pairs.against] == number)
            bounds[:, own] += obstacle.speed_bounds(x.breaks)[:, None]
    return np.asarray(bounds)


def _rates(pairs: ClearancePairs, x: PiecewisePolynomial) -> PiecewisePolynomial:
    """Return the rates of the positions; of a floating root the velocities of the state bound its motion."""
    robot = pairs.robot
    if robot.nq == robot.nv:
        rates = x.derivative()
        return PiecewisePolynomial(x.breaks, x.sites, [values[:, : robot.nq] for values in rates.values])
    return PiecewisePolynomial(x.breaks, x.sites, [values[:, robot.nq : robot.nq + robot.nv] for values in x.values])
