"""The collision shapes of a robot, as a translucent layer of the page."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pinocchio as pin

from robotraj.replay_page.scene.meshes import read_mesh
from robotraj.replay_page.scene.part import Color, Part, weld
from robotraj.replay_page.scene.shapes import shape_part
from robotraj.replay_page.scene.simplify import simplified
from robotraj.replay_page.scene.visuals import Visual

COLOR: Color = (0.84, 0.37, 0.0, 0.35)
MOST = 1500
"""Largest number of triangles of a drawn collision mesh; vertices of a larger one are merged in cells."""


def collision_shapes(geometry: pin.GeometryModel | None) -> tuple[Visual, ...]:
    """Return the shapes that Pinocchio's collision model has, each fixed to its joint; unknown kinds are left out."""
    found = []
    for thing in geometry.geometryObjects if geometry is not None else ():
        placement = np.array(thing.placement.homogeneous)
        parts = _mesh_parts(thing.meshPath) if type(thing.geometry).__name__.startswith("BVHModel") else ()
        if parts:
            placement = placement @ np.diag([*np.asarray(thing.meshScale, dtype=float).ravel(), 1.0])
        else:
            try:
                part = shape_part(thing.geometry)
            except LookupError:
                continue
            parts = (part,) if part is not None else ()
        if parts:
            colored = tuple((part, COLOR) for part in parts)
            found.append(Visual(int(thing.parentJoint), str(thing.name), placement, colored))
    return tuple(found)


@lru_cache(maxsize=256)
def _mesh_parts(path: str) -> tuple[Part, ...]:
    """Read a mesh with few triangles; none if the file cannot be read."""
    try:
        parts = read_mesh(path)
    except Exception:  # readers raise whatever their parsers raise, and the loaded mesh can stand in
        return ()
    small = (weld(*simplified(part.vertices.astype(float), part.faces, MOST)) for part in parts)
    return tuple(part for part in small if part is not None)
