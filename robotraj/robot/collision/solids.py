"""Collision shapes as solids: whether two of them overlap, and how deeply.

Two meshes overlap where their surfaces cross, which ``coal.collide`` finds. Their distance by ``coal.distance`` is 0
there, not negative. A shape inside a closed mesh crosses no surface; the mesh winds once around its points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import coal
import numpy as np
import numpy.typing as npt

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.collision.tessellation import subdivided, surface_of
from robotraj.robot.meshes.arrays import distinct
from robotraj.robot.meshes.convex_hull import convex_hull
from robotraj.robot.meshes.winding import Winding

if TYPE_CHECKING:
    from scipy.spatial import KDTree


MOST_BALLS = 8
"""Largest number of balls around a shape."""
UNBOUNDED = 1e6
"""Extent from which a shape counts as unbounded [m]."""
CELL = 0.01
"""Side of the cells of which each has one point of a surface [m]."""
WIDE_CELL = 0.025
"""The same for points over uneven ground [m]."""
MOST_TRIED = 20
"""Largest number of points that are compared for a depth."""
INSIDE = 0.5
"""Winding number above which a point is inside; it is 1 or 0 for closed meshes, and between them near holes."""
FINENESS = 20
"""Pieces of a surface along the longest extent of a shape."""
POINT = 1e-9
"""Radius of a ball that stands for a point [m]."""


@dataclass(frozen=True, eq=False)
class Solid(OneLine):
    """A collision shape of coal in its own axes."""

    geometry: coal.CollisionGeometry

    @cached_property
    def is_mesh(self) -> bool:
        """Whether coal knows the surface of the shape alone."""
        return type(self.geometry).__name__.startswith("BVHModel")

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Least and largest coordinates (3,), (3,) [m]."""
        self.geometry.computeLocalAABB()
        box = self.geometry.aabb_local
        return np.array(box.min_), np.array(box.max_)

    @cached_property
    def outer_points(self) -> Array:
        """Points (n, 3) whose convex hull encloses the shape [m]: a mesh's own, or the corners of its box."""
        if self.is_mesh:
            return np.array(self.geometry.vertices())
        # The square of a floor's largest coordinate would overflow.
        ends = np.clip(np.transpose(self.box), -UNBOUNDED, UNBOUNDED)
        return np.array(np.meshgrid(*ends, indexing="ij")).reshape(3, -1).T

    @cached_property
    def hull(self) -> coal.CollisionGeometry:
        """The convex hull of a mesh, or the shape itself, whose distances coal computes in microseconds."""
        if not self.is_mesh:
            return self.geometry
        return convex_hull(self.outer_points)

    @cached_property
    def extreme_points(self) -> Array:
        """Corners (n, 3) of the hull of a mesh, or of the box around another shape [m]."""
        if type(self.hull).__name__.startswith("Convex"):
            return np.array(self.hull.points())
        return self.outer_points

    @cached_property
    def balls(self) -> tuple[Array, Array]:
        """Centres (n, 3) and radii (n,) of balls around the shape's box [m]; one infinite ball where it has none."""
        lower, upper = self.box
        sides = np.minimum(upper, UNBOUNDED) - np.maximum(lower, -UNBOUNDED)
        if not np.all(np.abs(sides) < UNBOUNDED):
            return np.zeros((1, 3)), np.array([np.inf])
        counts = np.maximum(np.round(sides / max(sides.min(), sides.max() / MOST_BALLS)), 1.0).astype(int)
        while counts.prod() > MOST_BALLS:
            counts[np.argmax(counts)] -= 1
        steps = [low + (np.arange(n) + 0.5) * side / n for low, n, side in zip(lower, counts, sides, strict=True)]
        centres = np.array(np.meshgrid(*steps, indexing="ij")).reshape(3, -1).T
        return centres, np.full(len(centres), 0.5 * float(np.linalg.norm(sides / counts)))

    @cached_property
    def triangles(self) -> Array:
        """Triangles (f, 3, 3) of the surface [m]; of a shape with a curved surface, triangles near it."""
        return surface_of(self.geometry)

    @cached_property
    def corners(self) -> Array:
        """Points (n, 3) all over the surface [m]."""
        points = np.round(self._pieces.reshape(-1, 3), 9)
        return points[distinct(points)[0]]

    @cached_property
    def spots(self) -> Array:
        """Points (n, 3) of the surface, one in each cell of a grid of ``CELL`` or smaller [m]."""
        return self._in_cells(CELL)

    @cached_property
    def wide_spots(self) -> Array:
        """The same on a grid of ``WIDE_CELL`` or smaller [m]."""
        return self._in_cells(WIDE_CELL)

    def _in_cells(self, largest: float) -> Array:
        if not len(self.corners):
            return self.corners
        cell = min(largest, float(np.ptp(self.corners, axis=0).max()) / 10.0)
        return np.asarray(self.corners[distinct(np.floor(self.corners / cell))[0]])

    @cached_property
    def _winding(self) -> Winding:
        return Winding.of(self.triangles)

    @cached_property
    def _pieces(self) -> Array:
        """Small triangles (f, 3, 3) of the surface, counter-clockwise from outside [m]."""
        triangles = self.triangles
        if not triangles.size:
            return triangles
        if np.einsum("fi,fi", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) < 0.0:
            triangles = triangles[:, ::-1]
        extent = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
        return subdivided(triangles, max(extent / FINENESS, 1e-4))

    @cached_property
    def _tree(self) -> tuple[KDTree, Array]:
        """The middles of the pieces, and their outward normals (f, 3)."""
        from scipy.spatial import KDTree

        a, b, c = self._pieces.transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        # Few points are looked up, so a tree that is built sooner is the cheaper one.
        tree = KDTree((a + b + c) / 3.0, compact_nodes=False, balanced_tree=False)
        return tree, normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]

    def heights(self, points: Array, bound: float = np.inf) -> Array:
        """Return heights (n,) of points (n, 3) in its axes above the surface, negative inside [m].

        They are distances from the planes of the nearest pieces; infinite beyond a ``bound`` on the distance.
        """
        tree, normals = self._tree
        away, nearest = tree.query(points, distance_upper_bound=bound)
        known = np.isfinite(away)
        found, nearest = np.full(len(points), np.inf), nearest[known]
        found[known] = np.einsum("ni,ni->n", points[known] - tree.data[nearest], normals[nearest])
        return found

    def in_box(self, points: Array) -> npt.NDArray[np.bool_]:
        """Whether points (n, 3) in its axes lie in ``box``, (n,)."""
        lower, upper = self.box
        return np.asarray(np.all((points > lower) & (points < upper), axis=1))

    def contains(self, points: Array) -> npt.NDArray[np.bool_]:
        """Whether points (n, 3) in its axes lie inside the shape, (n,)."""
        found = self.in_box(points)
        for k in np.flatnonzero(found).tolist():
            if self.is_mesh:
                found[k] = abs(self._winding.number(points[k])) > INSIDE
            else:
                found[k] = self.distance(points[k]) < 0.0
        return found

    def distance(self, point: Array) -> float:
        """Return the distance of a point (3,) in its axes from a mesh's surface, or from a solid with its sign [m]."""
        there = coal.Transform3s(np.eye(3), point), self.geometry, coal.Transform3s()
        return float(coal.distance(coal.Sphere(POINT), *there, coal.DistanceRequest(), coal.DistanceResult())) + POINT

    def nearest(self, point: Array) -> Array:
        """Return the point (3,) of the surface that is nearest to a point (3,), both in its axes [m]."""
        there, found = coal.Transform3s(np.eye(3), point), coal.DistanceResult()
        coal.distance(coal.Sphere(POINT), there, self.geometry, coal.Transform3s(), coal.DistanceRequest(), found)
        return np.array(found.getNearestPoint2())


@dataclass(frozen=True, eq=False)
class Placed:
    """A solid in the world.

    Attributes
    ----------
    solid : Solid
    rotation, position : ndarray (3, 3), (3,)
        Of its axes; the position in [m].
    """

    solid: Solid
    rotation: Array
    position: Array

    @cached_property
    def place(self) -> coal.Transform3s:
        """The placement as coal takes it."""
        return coal.Transform3s(self.rotation, self.position)

    def in_world(self, points: Array) -> Array:
        """Return points (n, 3) of this shape's axes in the world."""
        return np.asarray(points @ self.rotation.T + self.position)

    def seen_from(self, other: Placed, points: Array) -> Array:
        """Return points (n, 3) of this shape in the axes of another one."""
        return np.asarray((self.in_world(points) - other.position) @ other.rotation)


def touch(first: Placed, second: Placed, margin: float = 0.0) -> bool:
    """Whether two shapes are nearer than a margin [m], or overlap with margin 0; of meshes, the surfaces alone."""
    request = coal.CollisionRequest()
    request.security_margin = margin
    pair = first.solid.geometry, first.place, second.solid.geometry, second.place
    return bool(coal.collide(*pair, request, coal.CollisionResult()))


def one_inside(first: Placed, second: Placed) -> bool:
    """Whether one shape lies inside the other one, a mesh, where their surfaces do not cross."""
    return any(
        outer.solid.is_mesh
        # The centre of a box around a shape lies in every other box around the shape.
        and bool(outer.solid.in_box(inner.seen_from(outer, np.mean(inner.solid.box, axis=0)[None]))[0])
        and bool(outer.solid.contains(inner.seen_from(outer, inner.solid.corners[:1])).any())
        for inner, outer in ((first, second), (second, first))
    )


def hull_distance(first: Placed, second: Placed) -> float:
    """Return the distance of the convex hulls of two shapes [m], a bound of theirs; negative where they overlap."""
    pair = first.solid.hull, first.place, second.solid.hull, second.place
    return float(coal.distance(*pair, coal.DistanceRequest(), coal.DistanceResult()))


def hull_points(first: Placed, second: Placed) -> tuple[float, Array, Array]:
    """Return the distance of the convex hulls of two shapes [m], and the nearest points (3,) of both in the world."""
    return _nearest(first.solid.hull, first.place, second.solid.hull, second.place)


def surface_points(first: Placed, second: Placed) -> tuple[float, Array, Array]:
    """Return the distance of two shapes [m], and the nearest points (3,) of both in the world."""
    return _nearest(first.solid.geometry, first.place, second.solid.geometry, second.place)


def _nearest(*pair: coal.CollisionGeometry | coal.Transform3s) -> tuple[float, Array, Array]:
    found = coal.DistanceResult()
    apart = coal.distance(*pair, coal.DistanceRequest(), found)
    return float(apart), np.array(found.getNearestPoint1()), np.array(found.getNearestPoint2())


def distance(first: Placed, second: Placed) -> float:
    """Return the distance of two surfaces [m], negative between solids that overlap unless both are meshes."""
    pair = first.solid.geometry, first.place, second.solid.geometry, second.place
    return float(coal.distance(*pair, coal.DistanceRequest(), coal.DistanceResult()))


def depth(first: Placed, second: Placed) -> float:
    """Return how deeply one of two overlapping shapes reaches into the other [m].

    This is the largest distance of a point of one surface, inside the other shape, from the surface of that shape. The
    points are those of a subdivision of the surfaces: where edges cross and no such point is inside, the depth is 0.
    """
    deepest = 0.0
    for inner, outer in ((first, second), (second, first)):
        points = inner.seen_from(outer, inner.solid.corners)
        points = points[outer.solid.in_box(points)]
        if len(points) and outer.solid.triangles.size:
            # The deepest point by the nearest pieces of those that are truly inside.
            order = np.argsort(outer.solid.heights(points))[:MOST_TRIED]
            inside = next((k for k in order.tolist() if outer.solid.contains(points[k : k + 1])[0]), None)
            deepest = max(deepest, 0.0 if inside is None else abs(outer.solid.distance(points[inside])))
    return deepest
