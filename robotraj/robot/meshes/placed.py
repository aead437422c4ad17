"""The shapes of a URDF with meshes that were read beforehand.

Pinocchio reads a URDF and its meshes in one call. Here every mesh is a sphere in that call, and takes its place after.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.meshes.arrays import MeshArrays

FIRST = 1e9
"""Radius of the sphere that stands for the first mesh [m]; that of the next one is 1 larger."""
LARGEST = 1e6
"""Largest factor of a scale, and the inverse of the smallest one."""


def with_meshes(
    model: pin.Model, root: Element, kind: pin.GeometryType, read: Mapping[Path, MeshArrays | str]
) -> pin.GeometryModel:
    """Return the geometry model of a URDF whose meshes were read.

    Parameters
    ----------
    model : pinocchio.Model
    root : Element
        The URDF; each mesh names a key of ``read``.
    kind : pinocchio.GeometryType
    read : mapping
    """
    meshes: list[Element] = []
    convex = _convex(root)
    for geometry in root.iter("geometry"):
        mesh = geometry.find("mesh")
        if mesh is not None:
            geometry.remove(mesh)
            geometry.append(Element("sphere", radius=repr(FIRST + len(meshes))))
            meshes.append(mesh)
    shapes = pin.buildGeomFromUrdfString(model, ElementTree.tostring(root, encoding="unicode"), kind)
    for shape in shapes.geometryObjects:
        if type(shape.geometry).__name__ == "Sphere" and FIRST <= shape.geometry.radius < FIRST + len(meshes):
            mesh = meshes[int(shape.geometry.radius - FIRST)]
            path, scale = Path(mesh.get("filename", "")), scale_of(mesh)
            arrays = read[path]
            assert isinstance(arrays, MeshArrays)
            shape.geometry = arrays.hull(scale) if mesh in convex else arrays.shape(scale)
            shape.meshPath, shape.meshScale = str(path), scale
    return shapes


def _convex(root: Element) -> list[Element]:
    """Meshes whose hull is the shape: ``<collision_checking><convex name="..."/>`` names their collision element."""
    found = []
    for link in root.findall("link"):
        names = {each.get("name") for each in link.findall("collision_checking/convex")}
        for number, shape in enumerate(link.findall("collision")):
            if {shape.get("name"), f"{link.get('name')}_{number}"} & names:
                found += shape.findall("geometry/mesh")
    return found


def unread(mesh: Element, read: MeshArrays | str) -> str | None:
    """Return why a mesh cannot be placed, or None."""
    if isinstance(read, str):
        return read
    try:
        scale_of(mesh)
    except ValueError as error:
        return str(error)
    return None


def scale_of(mesh: Element) -> Array:
    """Return the factors of a mesh along its axes (3,).

    Raises
    ------
    ValueError
        They are not one or three finite numbers other than zero.
    """
    text = mesh.get("scale", "1 1 1")
    try:
        factors = np.array([float(word) for word in text.split()])
    except ValueError:
        factors = np.zeros(0)
    if factors.shape not in ((1,), (3,)):
        raise ValueError(f"its scale {text[:40]!r} is no three numbers")
    if not np.all((np.abs(factors) <= LARGEST) & (np.abs(factors) >= 1.0 / LARGEST)):
        raise ValueError(f"its scale {text[:40]!r} is not between {1.0 / LARGEST:g} and {LARGEST:g}")
    return np.broadcast_to(factors, (3,)).copy()
