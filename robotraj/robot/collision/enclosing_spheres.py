"""Spheres that enclose a surface: every triangle of a fine subdivision lies entirely in one sphere.

The surface is split into parts, each with its smallest enclosing ball. The part with the largest ball, of those that
protrude beyond the surface, is split next, along the axis that leaves the least volume. A ball is convex, so a triangle
lies in it where its corners do: the enclosure is exact, not sampled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj.robot.collision.tessellation import sphere_points, subdivided

EXCESS = 0.01
"""Distance beyond the surface that a sphere may protrude [m]."""
MOST = 10
"""Largest number of spheres of a shape. It takes precedence over ``EXCESS``, since flat ends need many spheres."""
FINENESS = 20
"""Pieces of the subdivision along the longest extent of a shape."""
MOST_PIECES = 200_000
"""Largest number of pieces that subdivision adds; a mesh of many long triangles is subdivided less."""
MANY, CELLS = 50_000, 60
"""Pieces from which one in each cell of a grid stands for the others, and cells along the longest extent."""
STEPS = 40
"""Steps of the iteration for a smallest enclosing ball."""
VOLUME_SAMPLES = 5_000


class Fit(NamedTuple):
    """Spheres of one shape.

    Attributes
    ----------
    centres, radii : ndarray (n, 3), (n,)
        [m].
    protrusion : float
        Largest distance of a point of a sphere beyond the surface [m].
    volume : float
        Volume of the union of the spheres [m^3].
    hull_volume : float
        Volume of the convex hull of the shape [m^3].
    """

    centres: Array
    radii: Array
    protrusion: float
    volume: float
    hull_volume: float


def enclose(triangles: Array, excess: float = EXCESS, most: int = MOST) -> Fit:
    """Fit spheres to triangles (f, 3, 3) [m]; the result satisfies ``encloses``."""
    pieces = _pieces(triangles)
    few, cell = _spread(pieces)
    surface = _Surface(few)
    parts = [_part(few, surface)]
    while len(parts) < most:
        splittable = [i for i, part in enumerate(parts) if part.protrusion > excess and len(part.pieces) > 1]
        if not splittable:
            break
        worst = max(splittable, key=lambda i: parts[i].protrusion * parts[i].radius ** 2)
        parts[worst : worst + 1] = _split(parts[worst].pieces, surface)
    centres = np.array([part.centre for part in parts])
    radii = _grown(centres, np.array([part.radius for part in parts]), pieces, few, cell)
    protrusion = max(map(surface.protrusion, centres, radii))
    return Fit(centres, radii, protrusion, union_volume(centres, radii), _hull_volume(few))


def _pieces(triangles: Array) -> Array:
    extent = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    longest = max(extent / FINENESS, 1e-4)
    edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    # Each halving of its edges makes four pieces of a triangle.
    while longest < extent and np.sum(4.0 ** np.ceil(np.log2(np.maximum(edges / longest, 1.0))) - 1.0) > MOST_PIECES:
        longest *= 2.0
    return subdivided(triangles, longest)


def _spread(pieces: Array) -> tuple[Array, Indices]:
    """Return of many pieces the outermost one in each cell of a grid, and the number of the one of each piece."""
    if len(pieces) <= MANY:
        return pieces, np.arange(len(pieces))
    middles = pieces.mean(axis=1)
    low, extent = middles.min(axis=0), max(float(np.ptp(middles, axis=0).max()), 1e-300)
    cells = np.floor((middles - low) / extent * CELLS).astype(np.int64) @ [1, CELLS + 1, (CELLS + 1) ** 2]
    order = np.argsort(-np.linalg.norm(middles - middles.mean(axis=0), axis=1))
    _, first, cell = np.unique(cells[order], return_index=True, return_inverse=True)
    numbers = np.empty_like(cell)
    numbers[order] = cell
    return np.asarray(pieces[order[first]]), numbers


def _grown(centres: Array, radii: Array, pieces: Array, few: Array, cell: Indices) -> Array:
    """Return radii with which each piece lies in the sphere that grows least for the piece of its cell."""
    growth = [_reach(few, centre) - radius for centre, radius in zip(centres, radii, strict=True)]
    owner = np.argmin(growth, axis=0)[cell]
    grown = radii.copy()
    np.maximum.at(grown, owner, _reach(pieces, centres[owner, None]) * (1.0 + 1e-12))
    return grown


def _reach(pieces: Array, centre: Array) -> Array:
    """Largest distance of a corner of each piece from a centre [m], (n,)."""
    return np.asarray(np.sqrt(np.square(pieces - centre).sum(axis=2).max(axis=1)))


def encloses(centres: Array, radii: Array, triangles: Array) -> bool:
    """Whether each piece of a fine subdivision of the triangles lies entirely in one sphere."""
    pieces = _pieces(triangles)
    held = np.zeros(len(pieces), dtype=bool)
    for centre, radius in zip(centres, radii, strict=True):
        held |= _reach(pieces, centre) <= radius * (1.0 + 1e-9)
    return bool(held.all())


def union_volume(centres: Array, radii: Array) -> float:
    """Volume [m^3] of the union of spheres, by seeded samples of every sphere."""
    rng = np.random.default_rng(0)
    volumes = 4.0 / 3.0 * np.pi * radii**3
    count = max(VOLUME_SAMPLES // len(radii), 100)
    total = 0.0
    for centre, radius, volume in zip(centres, radii, volumes, strict=True):
        directions = rng.normal(size=(count, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        points = centre + radius * rng.random((count, 1)) ** (1.0 / 3.0) * directions
        # A point in k spheres is sampled in each of them: it counts 1 / k.
        inside = np.linalg.norm(points[:, None] - centres, axis=2) <= radii * (1.0 + 1e-12)
        total += volume * float(np.mean(1.0 / np.maximum(inside.sum(axis=1), 1)))
    return total


class _Cluster(NamedTuple):
    pieces: Array
    centre: Array
    radius: float
    protrusion: float


class _Surface:
    """Distances beyond the surface, by its nearest pieces."""

    def __init__(self, pieces: Array) -> None:
        from scipy.spatial import cKDTree

        self.middles = pieces.mean(axis=1)
        normals = np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])
        self.normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        self.tree = cKDTree(self.middles)
        self.directions = sphere_points(96)

    def protrusion(self, centre: Array, radius: float) -> float:
        points = centre + radius * self.directions
        distance, nearest = self.tree.query(points)
        outside = np.einsum("ij,ij->i", points - self.middles[nearest], self.normals[nearest]) > 0.0
        return float(np.max(np.where(outside, distance, 0.0)))


def _part(pieces: Array, surface: _Surface) -> _Cluster:
    centre, radius = smallest_ball(pieces.reshape(-1, 3))
    return _Cluster(pieces, centre, radius, surface.protrusion(centre, radius))


def smallest_ball(points: Array) -> tuple[Array, float]:
    """Return a ball that encloses points (m, 3), at most a few percent larger than the smallest one.

    Source: Badoiu and Clarkson, Smaller core-sets for balls, SODA 2003.
    """
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    for step in range(1, STEPS):
        away = points - centre
        farthest = int(np.argmax(np.einsum("ij,ij->i", away, away)))
        centre = centre + away[farthest] / (step + 1.0) ** 2
    return centre, float(np.linalg.norm(points - centre, axis=1).max()) * (1.0 + 1e-12)


def _split(pieces: Array, surface: _Surface) -> list[_Cluster]:
    """Split pieces in halves along the axis that leaves the least volume."""
    middles = pieces.mean(axis=1)
    best, least = np.arange(len(pieces)) < len(pieces) // 2, np.inf
    for axis in np.linalg.svd(middles - middles.mean(axis=0), full_matrices=False)[2]:
        along = middles @ axis
        lower = along <= 0.5 * (along.min() + along.max())
        if lower.all() or not lower.any():
            continue
        size = sum(smallest_ball(middles[side])[1] ** 3 for side in (lower, ~lower))
        if size < least:
            best, least = lower, size
    return [_part(pieces[side], surface) for side in (best, ~best)]


def _hull_volume(pieces: Array) -> float:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(pieces.reshape(-1, 3)).volume)
    except QhullError:
        return 0.0
