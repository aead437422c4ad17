"""Geometric primitives of a URDF, converted from coal's shapes to triangles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh import creation

from robotraj.replay_page.scene.part import Part, weld
from robotraj.replay_page.scene.simplify import MOST, simplified
from robotraj.robot.collision.tessellation import corners_of

PLANE_SIDE = 4.0
"""Side [m] of the square that represents an infinite plane."""


def shape_part(shape: coal.CollisionGeometry, most: int = MOST) -> Part | None:
    """Triangulate a coal shape in its own frame (axes along z, centred as coal defines it).

    Parameters
    ----------
    shape : coal.CollisionGeometry
        Box, Sphere, Ellipsoid, Cylinder, Capsule, Cone, Plane, Halfspace, Convex or triangles (BVHModel).
    most : int
        Triangles of a mesh from which vertices are merged in cells.

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
        return weld(*simplified(np.array(shape.vertices()), corners_of(shape), most))
    if kind.startswith("Convex"):
        hull = trimesh.convex.convex_hull(np.asarray(shape.points()))
        return weld(hull.vertices, hull.faces)
    if kind not in _MAKERS:
        raise LookupError(kind)
    return _primitive(kind, *(float(each) for name in _MAKERS[kind][0] for each in np.ravel(getattr(shape, name))))


@lru_cache(maxsize=256)
def _primitive(kind: str, *sizes: float) -> Part | None:
    """Return the part of a shape by its sizes: scenes have many alike, and each is drawn and framed."""
    mesh = _MAKERS[kind][1](*sizes)
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


def _plane(x: float, y: float, z: float, d: float) -> trimesh.Trimesh:
    mesh = creation.box(extents=[PLANE_SIDE, PLANE_SIDE, 1e-3])
    mesh.apply_translation([0.0, 0.0, -5e-4])
    mesh.apply_transform(trimesh.geometry.align_vectors([0.0, 0.0, 1.0], [x, y, z]))
    mesh.apply_translation(np.array([x, y, z]) * d)
    return mesh


def _ellipsoid(*radii: float) -> trimesh.Trimesh:
    mesh = creation.uv_sphere(radius=1.0, count=[24, 24])
    mesh.apply_scale(radii)
    return mesh


def _cone(radius: float, half: float) -> trimesh.Trimesh:
    mesh = creation.cone(radius=radius, height=2.0 * half, sections=48)
    mesh.apply_translation([0.0, 0.0, -half])
    return mesh


_MAKERS: Mapping[str, tuple[Sequence[str], Callable[..., trimesh.Trimesh]]] = {
    "Box": (("halfSide",), lambda *half: creation.box(extents=2.0 * np.array(half))),
    "Sphere": (("radius",), lambda radius: creation.uv_sphere(radius=radius, count=[24, 24])),
    "Ellipsoid": (("radii",), _ellipsoid),
    "Cylinder": (
        ("radius", "halfLength"),
        lambda radius, half: creation.cylinder(radius=radius, height=2.0 * half, sections=48),
    ),
    "Capsule": (
        ("radius", "halfLength"),
        lambda radius, half: creation.capsule(radius=radius, height=2.0 * half, count=[24, 24]),
    ),
    "Cone": (("radius", "halfLength"), _cone),
    "Plane": (("n", "d"), _plane),
    "Halfspace": (("n", "d"), _plane),
}
"""Names of the sizes of each kind in coal, and a function of them."""
