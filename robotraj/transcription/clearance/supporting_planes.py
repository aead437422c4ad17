"""Planes between shapes: the constants of rows whose normals are fixed along a known motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.problem.clearance.pairs import ClearancePairs

Motion = Callable[[Array], tuple[Array, Array]]
"""From fractions of a phase (m,) to positions (m, nq) and times (m,) [s]."""

STEP = 1e-6
"""Step of the central difference of a distance [m]."""


def motion_of(x: PiecewisePolynomial, nq: int) -> Motion:
    """Return the motion of a solution whose states x in time begin with the nq positions."""
    first, last = float(x.breaks[0]), float(x.breaks[-1])

    def motion(s: Array) -> tuple[Array, Array]:
        times = first + s * (last - first)
        return x(times)[:, :nq], times

    return motion


def planes(pairs: ClearancePairs, chosen: Indices, q: Array, times: Array | None = None) -> Array:
    """Return normals and offsets (n, 4) of pairs with one function, tangent to their distance at positions (n, nq).

    Joints that move both spheres of a pair are neutral in ``q``, as in ``distance_functions``. Moving obstacles have
    their poses at ``times`` (n,) [s].
    """
    first, second = pairs.first[chosen], pairs.second[chosen]
    radius, here = pairs.spheres.radius, pairs.centres_of(first, q)
    if chosen[0] >= pairs.against:
        apart = here - pairs.centres_of(second, q)
        normals = apart / np.maximum(np.linalg.norm(apart, axis=1), 1e-12)[:, None]
        return np.column_stack([normals, radius[first] + radius[second]])
    out = np.empty((len(chosen), 4))
    for number in np.unique(second).tolist():
        own = second == number
        at = np.zeros(np.count_nonzero(own)) if times is None else times[own]
        distance, out[own, :3] = _tangent(pairs.obstacles[number], here[own], at)
        out[own, 3] = np.einsum("ij,ij->i", out[own, :3], here[own]) - distance + radius[first[own]]
    return out


def heights(pairs: ClearancePairs, chosen: Indices, q: Array, given: Array) -> Array:
    """Return n' p - offset (n,) [m] of planes (n, 4) at positions (n, nq)."""
    at = pairs.centres_of(pairs.first[chosen], q)
    if chosen[0] >= pairs.against:
        at = at - pairs.centres_of(pairs.second[chosen], q)
    return np.asarray(np.einsum("ij,ij->i", given[:, :3], at) - given[:, 3])


def in_axes(obstacle: Obstacle, times: Array, given: Array) -> Array:
    """Return planes (n, 4) of the world in the axes of an obstacle at times (n,) [s]."""
    positions, rotations = obstacle.poses(times)
    normals = np.einsum("nij,ni->nj", rotations, given[:, :3])
    return np.column_stack([normals, given[:, 3] - np.einsum("ni,ni->n", given[:, :3], positions)])


def in_world(obstacle: Obstacle, times: Array, given: Array) -> Array:
    """Return planes (n, 4) in the axes of an obstacle in the world at times (n,) [s]."""
    positions, rotations = obstacle.poses(times)
    normals = np.einsum("nij,nj->ni", rotations, given[:, :3])
    return np.column_stack([normals, given[:, 3] + np.einsum("ni,ni->n", normals, positions)])


def _tangent(obstacle: Obstacle, points: Array, times: Array) -> tuple[Array, Array]:
    """Return signed distances (n,) and their unit gradients (n, 3) at points of the world (n, 3) and times (n,) [s]."""
    positions, rotations = obstacle.poses(times)
    local = np.einsum("ni,nij->nj", points - positions, rotations)
    steps = STEP * np.vstack([np.eye(3), -np.eye(3)])
    around = obstacle.distance((local[:, None] + steps).reshape(-1, 3)).reshape(-1, 2, 3)
    gradients = np.einsum("nij,nj->ni", rotations, around[:, 0] - around[:, 1])
    return obstacle.distance(local), gradients / np.maximum(np.linalg.norm(gradients, axis=1), 1e-300)[:, None]
