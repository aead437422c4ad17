"""The unit of a COLLADA file, which Pinocchio's reader ignores.

The up axis is not applied: URDFs are made to look right in RViz, which keeps the axes of the file as well.
"""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from robotraj.robot.size.reach import reach
from robotraj.robot.urdf.numbers import numbers

HEAD = 65_536
"""Bytes at the beginning of a file in which the unit stands."""
UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']\s*([0-9.eE+-]+)\s*[\"']")
LARGE, SMALL = 30.0, 1e-3
"""Sizes of a mesh relative to the reach of the robot above and below which it is doubted."""


def unit_of(path: Path) -> float:
    """Return the length of the unit of a mesh file [m]: that of COLLADA files, 1 for others."""
    if path.suffix.lower() != ".dae":
        return 1.0
    with path.open("rb") as stream:
        found = UNIT.search(stream.read(HEAD))
    try:
        unit = float(found.group(1)) if found else 1.0
    except ValueError:
        return 1.0
    return unit if 0.0 < unit < np.inf else 1.0


def scale_by(mesh: Element, unit: float) -> None:
    """Multiply the scale of a ``<mesh>`` by a unit [m]."""
    factors = numbers(mesh.get("scale", "1 1 1"), 3)
    if unit != 1.0 and factors is not None:
        mesh.set("scale", " ".join(repr(factor * unit) for factor in factors))


def doubted_sizes(model: pin.Model, shapes: pin.GeometryModel) -> list[str]:
    """Return links whose mesh is far larger or far smaller than the robot, each with the size of the mesh."""
    span = reach(model)
    found = []
    for shape in shapes.geometryObjects if span > 0.0 else ():
        if not shape.meshPath or type(shape.geometry).__name__ in ("Box", "Sphere", "Cylinder", "Capsule"):
            continue
        shape.geometry.computeLocalAABB()
        size = float(np.max(shape.geometry.aabb_local.max_ - shape.geometry.aabb_local.min_))
        if np.isfinite(size) and not SMALL * span <= size <= LARGE * span:
            found.append(f"{model.frames[shape.parentFrame].name} ({size:.3g} m)")
    return found
