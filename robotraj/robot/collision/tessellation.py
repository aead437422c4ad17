"""Triangles whose union contains the surface of a collision shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.robot.meshes.convex_hull import thickened

if TYPE_CHECKING:
    import coal


SIDES = 24
"""Sides of the prism around a cylinder."""
HALF_SPACES = ("Halfspace", "Plane")
"""Kinds of coal's shapes that are unbounded, such as the floor of an MJCF file."""
POINTS = 128
"""Corners of a polyhedron in a sphere."""


def triangles_of(shape: coal.CollisionGeometry, name: str) -> Array:
    """Return triangles (f, 3, 3) [m] in the axes of a coal shape, a box, cylinder, cone, ellipsoid or mesh.

    Raises
    ------
    InputError
        The shape is of another kind.
    """
    kind = type(shape).__name__
    if kind.startswith("BVHModel"):
        return outward(np.array(shape.vertices())[corners_of(shape)])
    if kind == "Box":
        return box_triangles(np.array(shape.halfSide))
    if kind in ("Cylinder", "Cone"):
        return cylinder_triangles(float(shape.radius), float(shape.halfLength))
    if kind == "Ellipsoid":
        return box_triangles(np.array(shape.radii))
    if kind.startswith("Convex"):
        return hull_triangles(np.array(shape.points()))
    raise InputError(f"The collision shape {name!r} is a {kind}, which spheres cannot enclose; use a mesh.")


def corners_of(mesh: coal.BVHModelBase) -> npt.NDArray[np.int32]:
    """Return the numbers of the corners of the triangles of coal's mesh, (f, 3); lists would take far more memory."""
    count = int(mesh.num_tris)
    numbers = (triangle[k] for triangle in map(mesh.tri_indices, range(count)) for k in range(3))
    return np.fromiter(numbers, np.int32, 3 * count).reshape(-1, 3)


def surface_of(shape: coal.CollisionGeometry) -> Array:
    """Return triangles (f, 3, 3) [m] near the surface of a bounded shape of coal; none of an unbounded one."""
    kind = type(shape).__name__
    if kind in HALF_SPACES:
        return np.zeros((0, 3, 3))
    if kind == "Sphere":
        return hull_triangles(float(shape.radius) * sphere_points())
    if kind == "Ellipsoid":
        return hull_triangles(np.array(shape.radii) * sphere_points())
    if kind == "Capsule":
        ends = float(shape.radius) * sphere_points()
        half = np.array([0.0, 0.0, float(shape.halfLength)])
        return hull_triangles(np.concatenate([ends - half, ends + half]))
    return triangles_of(shape, kind)


def sphere_points(count: int = POINTS) -> Array:
    """Return points (count, 3) that are spread evenly over the unit sphere, along a spiral."""
    k = np.arange(count) + 0.5
    polar, azimuth = np.arccos(1.0 - 2.0 * k / count), np.pi * (1.0 + 5.0**0.5) * k
    return np.column_stack([np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)])


def outward(triangles: Array) -> Array:
    """Return triangles (f, 3, 3) that are counter-clockwise from outside; a mirrored mesh has them the other way round.

    The volume about the mean of the corners, a sixth of the sum of a . (b x c), is negative then.
    """
    a, b, c = (triangles - triangles.mean(axis=(0, 1))).transpose(1, 0, 2)
    inside_out = np.einsum("fi,fi->", a, np.cross(b, c)) < 0.0
    return np.asarray(triangles[:, ::-1] if inside_out else triangles)


def subdivided(triangles: Array, longest: float) -> Array:
    """Split triangles at the middles of their edges until no edge is longer than ``longest`` [m]."""
    done = []
    while triangles.size:
        edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
        done.append(triangles[edges <= longest])
        a, b, c = triangles[edges > longest].transpose(1, 0, 2)
        ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate(done) if done else np.zeros((0, 3, 3))


def box_triangles(half: Array) -> Array:
    """Return the faces of a box with half its sides (3,) [m]."""
    return hull_triangles(np.array(np.meshgrid(*((-h, h) for h in half), indexing="ij")).reshape(3, -1).T)


def cylinder_triangles(radius: float, half: float) -> Array:
    """Return the faces of a prism around a cylinder about z with half its length [m]."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    rim = radius / np.cos(np.pi / SIDES) * np.column_stack([np.cos(angles), np.sin(angles)])
    return hull_triangles(np.concatenate([np.column_stack([rim, np.full(SIDES, z)]) for z in (-half, half)]))


def hull_triangles(points: Array) -> Array:
    """Return the faces of the convex hull of points (n, 3), counter-clockwise from outside; flat ones are thickened."""
    from scipy.spatial import ConvexHull

    points = thickened(points)
    hull = ConvexHull(points)
    corners = points[hull.simplices].copy()
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wrong = np.einsum("fi,fi->f", normals, hull.equations[:, :3]) < 0.0
    corners[wrong] = corners[wrong][:, ::-1]
    return np.asarray(corners)
