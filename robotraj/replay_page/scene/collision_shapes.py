"""The collision shapes of a robot, as a translucent layer of the page."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj.replay_page.scene.part import Color, weld
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
        try:
            part = shape_part(thing.geometry)
        except LookupError:
            continue
        if part is not None and len(part.faces) > MOST:
            part = weld(*simplified(part.vertices.astype(float), part.faces, MOST))
        if part is not None:
            found.append(Visual(int(thing.parentJoint), str(thing.name), placement, ((part, COLOR),)))
    return tuple(found)
