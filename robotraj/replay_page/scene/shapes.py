"""Geometric primitives of a URDF, converted from coal's shapes to triangles."""

from __future__ import annotations

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh import creation

from robotraj.replay_page.scene.part import Part, weld

PLANE_SIDE = 4.0
"""Side [m] of the square that represents an infinite plane."""


def shape_part(shape: coal.CollisionGeometry) -> Part | None:
    """Triangulate a coal shape in its own frame (axes along z, centred as coal defines it).

    Parameters
    ----------
    shape : coal.CollisionGeometry
        Box, Sphere, Ellipsoid, Cylinder, Capsule, Cone, Plane, Halfspace, Convex or triangles (BVHModel).

    Returns
    -------
    Part or None
        Without colour; None if the shape has no extent.

    Raises
    ------
    LookupError
        Names a kind that has no triangles here.
    """
    kind = type(shape).__name__
    if kind.startswith("BVHModel"):
        triangles = [shape.tri_indices(i) for i in range(shape.num_tris)]
        return weld(np.asarray(shape.vertices()), np.array([[t[0], t[1], t[2]] for t in triangles], dtype=int))
    if kind.startswith("Convex"):
        hull = trimesh.convex.convex_hull(np.asarray(shape.points()))
        return weld(hull.vertices, hull.faces)
    maker = _MAKERS.get(kind)
    if maker is None:
        raise LookupError(kind)
    mesh = maker(shape)
    return weld(mesh.vertices, mesh.faces)


def rod(start: NDArray[np.float64], end: NDArray[np.float64], radius: float) -> Part | None:
    """Capsule of a radius [m] from one point to another [m], for models without visuals."""
    axis = np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    length = float(np.linalg.norm(axis))
    mesh = creation.capsule(height=length, radius=radius, count=[20, 20])
    if length > 0.0:
        mesh.apply_transform(trimesh.geometry.align_vectors([0.0, 0.0, 1.0], axis / length))
    mesh.apply_translation((np.asarray(start) + np.asarray(end)) / 2.0)
    return weld(mesh.vertices, mesh.faces)


def tube(points: NDArray[np.float64], radius: float, sides: int = 6) -> Part:
    """Tube of a radius [m] along a polyline (n, 3) [m]; 6 n - 6 quads, ordered along the line.

    The order of the faces lets a page draw only the part already travelled. Rings turn with the line by the
    smallest rotation (parallel transport), so the tube does not twist.
    """
    tangents = np.gradient(points, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    normal = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
    angles = 2.0 * np.pi * np.arange(sides) / sides
    rings = []
    for point, tangent in zip(points, tangents, strict=True):
        normal = normal - tangent * (normal @ tangent)
        normal /= np.linalg.norm(normal)
        side = np.cross(tangent, normal)
        rings.append(point + radius * (np.outer(np.cos(angles), normal) + np.outer(np.sin(angles), side)))
    base = np.arange(len(points) - 1)[:, None] * sides
    here = np.arange(sides)
    a, b = base + here, base + (here + 1) % sides
    faces = np.stack([np.stack([a, b, a + sides], axis=-1), np.stack([b, b + sides, a + sides], axis=-1)], axis=2)
    kind = np.uint16 if len(points) * sides <= np.iinfo(np.uint16).max else np.uint32
    return Part(np.concatenate(rings).astype(np.float32), faces.reshape(-1, 3).astype(kind))


def _plane(shape: coal.CollisionGeometry) -> trimesh.Trimesh:
    normal = np.asarray(shape.n, dtype=float).ravel()
    mesh = creation.box(extents=[PLANE_SIDE, PLANE_SIDE, 1e-3])
    mesh.apply_translation([0.0, 0.0, -5e-4])
    mesh.apply_transform(trimesh.geometry.align_vectors([0.0, 0.0, 1.0], normal))
    mesh.apply_translation(normal * float(shape.d))
    return mesh


def _ellipsoid(shape: coal.CollisionGeometry) -> trimesh.Trimesh:
    mesh = creation.uv_sphere(radius=1.0, count=[24, 24])
    mesh.apply_scale(np.asarray(shape.radii, dtype=float).ravel())
    return mesh


def _cone(shape: coal.CollisionGeometry) -> trimesh.Trimesh:
    mesh = creation.cone(radius=shape.radius, height=2.0 * shape.halfLength, sections=48)
    mesh.apply_translation([0.0, 0.0, -shape.halfLength])
    return mesh


_MAKERS = {
    "Box": lambda s: creation.box(extents=2.0 * np.asarray(s.halfSide).ravel()),
    "Sphere": lambda s: creation.uv_sphere(radius=s.radius, count=[24, 24]),
    "Ellipsoid": _ellipsoid,
    "Cylinder": lambda s: creation.cylinder(radius=s.radius, height=2.0 * s.halfLength, sections=48),
    "Capsule": lambda s: creation.capsule(radius=s.radius, height=2.0 * s.halfLength, count=[24, 24]),
    "Cone": _cone,
    "Plane": _plane,
    "Halfspace": _plane,
}
