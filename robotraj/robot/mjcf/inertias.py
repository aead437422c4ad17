"""Masses and inertias of bodies of an MJCF file that are those of its shapes.

MuJoCo takes them from the shapes where a body has no ``<inertial>``, or where ``inertiafromgeom`` is true. Pinocchio's
reader does it, too, but takes 1 kg for a mesh, nothing for a shape between two ends, and no mass of a default class.
Each body is therefore given its ``<inertial>``.

Source: *inertial*, *geom* and *compiler* in MuJoCo's documentation of its XML format.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.robot.collision.tessellation import hull_triangles
from robotraj.robot.meshes.arrays import MeshArrays
from robotraj.robot.mjcf.defaults import Attributes
from robotraj.robot.mjcf.placement import Placement

DENSITY = 1000.0
"""Of shapes that state neither mass nor density [kg/m^3]."""
MASSLESS = ("plane", "hfield")
READ = ("inertiafromgeom", "inertiagrouprange", "balanceinertia", "settotalmass")
"""Attributes of the compiler that the masses follow from."""


def with_inertias(file: str, root: Element, meshes: Mapping[str, MeshArrays]) -> None:
    """Give every body whose inertia is that of its shapes an ``<inertial>``.

    Parameters
    ----------
    file : str
        Name of the file, for messages.
    root : Element
        The file without default classes, which is changed.
    meshes : mapping of str to MeshArrays
        Its meshes by name, in the axes of their references, without their scales.

    Raises
    ------
    InputError
        The mass of a shape is not known. Names the shape.
    """
    compilers = root.findall("compiler")
    given = {name: text for compiler in compilers for name, text in compiler.attrib.items()}
    place = Placement(root)
    assets = {mesh.get("name", ""): mesh.attrib for group in root.findall("asset") for mesh in group.iter("mesh")}
    first, last = (int(float(number)) for number in given.get("inertiagrouprange", "0 5").split()[:2])
    for body in _bodies(root):
        stated = body.find("inertial")
        if given.get("inertiafromgeom") == "false" or (stated is not None and given.get("inertiafromgeom") != "true"):
            continue
        own = [geom.attrib for geom in body.findall("geom")]
        parts = [
            place.of(geom).act(_inertia(file, geom, assets, meshes))
            for geom in own
            if first <= int(float(geom.get("group", "0"))) <= last and _has_mass(geom)
        ]
        if parts:
            whole = sum(parts[1:], parts[0])
            if stated is not None:
                body.remove(stated)
            matrix = np.array(whole.inertia)
            SubElement(
                body,
                "inertial",
                pos=_text(whole.lever),
                mass=repr(float(whole.mass)),
                fullinertia=_text([*np.diag(matrix), matrix[0, 1], matrix[0, 2], matrix[1, 2]]),
            )
    if given.get("balanceinertia") == "true":
        _balance(root)
    _scale(root, float(given.get("settotalmass", "-1")))
    for compiler in compilers:
        for name in READ:
            compiler.attrib.pop(name, None)


def _bodies(root: Element) -> list[Element]:
    return [body for world in root.findall("worldbody") for body in world.iter("body")]


def _has_mass(geom: Attributes) -> bool:
    return geom.get("type", "sphere") not in MASSLESS and float(geom.get("mass", geom.get("density", "1"))) > 0.0


def _inertia(
    file: str, geom: Attributes, assets: Mapping[str, Attributes], meshes: Mapping[str, MeshArrays]
) -> pin.Inertia:
    """Return the inertia of a shape in its own axes."""
    kind, name = geom.get("type", "sphere"), geom.get("mesh", "")
    sizes = [float(word) for word in geom.get("size", "").split()]
    if "fromto" in geom:
        ends = np.array(geom["fromto"].split(), dtype=float)[:6].reshape(2, 3)
        half = 0.5 * float(np.linalg.norm(ends[1] - ends[0]))
        sizes = [sizes[0], half] if kind in ("capsule", "cylinder") else [sizes[0], sizes[0], half]
    hollow = geom.get("shellinertia") == "true"
    one: pin.Inertia | None = None
    if kind == "mesh" and name in meshes:
        volume, one = _of_mesh(assets.get(name, {}), meshes[name])
    elif not name and kind in _SHAPES:
        volume, one = _SHAPES[kind](*sizes[: _COUNTS[kind]])
    if one is None or hollow or not volume > 0.0:
        raise InputError(
            f"{file}: the mass of the <geom> {geom.get('name', '')[:60]!r} of type {kind[:20]!r} is not known; give "
            "its body an <inertial>."
        )
    mass = float(geom["mass"]) if "mass" in geom else volume * float(geom.get("density", DENSITY))
    return pin.Inertia(mass, one.lever, mass * one.inertia)


def _sphere(radius: float) -> tuple[float, pin.Inertia]:
    return 4.0 / 3.0 * np.pi * radius**3, pin.Inertia.FromSphere(1.0, radius)


def _capsule(radius: float, half: float) -> tuple[float, pin.Inertia]:
    volume = np.pi * radius**2 * (2.0 * half + 4.0 / 3.0 * radius)
    return volume, pin.Inertia.FromCapsule(1.0, radius, 2.0 * half)


def _cylinder(radius: float, half: float) -> tuple[float, pin.Inertia]:
    return np.pi * radius**2 * 2.0 * half, pin.Inertia.FromCylinder(1.0, radius, 2.0 * half)


def _box(x: float, y: float, z: float) -> tuple[float, pin.Inertia]:
    return 8.0 * x * y * z, pin.Inertia.FromBox(1.0, 2.0 * x, 2.0 * y, 2.0 * z)


def _ellipsoid(x: float, y: float, z: float) -> tuple[float, pin.Inertia]:
    return 4.0 / 3.0 * np.pi * x * y * z, pin.Inertia.FromEllipsoid(1.0, x, y, z)


_SHAPES: dict[str, Callable[..., tuple[float, pin.Inertia]]] = {
    "sphere": _sphere,
    "capsule": _capsule,
    "cylinder": _cylinder,
    "box": _box,
    "ellipsoid": _ellipsoid,
}
_COUNTS = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def _of_mesh(asset: Attributes, mesh: MeshArrays) -> tuple[float, pin.Inertia | None]:
    """Return volume and inertia of 1 kg: tetrahedra between each triangle and the mean point of the surface.

    Their volumes count as positive by default, as meshes need not be closed; ``inertia="exact"`` adds them with their
    signs, and ``inertia="convex"`` takes the hull.
    """
    kind = asset.get("inertia", "legacy")
    if kind not in ("legacy", "exact", "convex"):
        return 0.0, None
    scale = np.array(asset.get("scale", "1 1 1").split(), dtype=float)[:3]
    points = mesh.vertices * scale
    corners = hull_triangles(np.unique(points, axis=0)) if kind == "convex" else points[mesh.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    centre = areas @ corners.mean(axis=1) / (areas.sum() or 1.0)
    edges = corners - centre
    volumes = np.linalg.det(edges) / 6.0
    volumes = np.abs(volumes) if kind == "legacy" else volumes * np.sign(volumes.sum())
    whole = float(volumes.sum())
    if not whole > 0.0:
        return 0.0, None
    mean = np.einsum("k,kci->i", volumes, edges) / (4.0 * whole)
    # Second moments of a tetrahedron with one corner at 0: (sum_c e_c e_c' + s s') V / 20, s = sum_c e_c.
    total = edges.sum(axis=1)
    second = np.einsum("k,kci,kcj->ij", volumes, edges, edges) + np.einsum("k,ki,kj->ij", volumes, total, total)
    second = second / (20.0 * whole) - np.outer(mean, mean)
    return whole, pin.Inertia(1.0, centre + mean, np.trace(second) * np.eye(3) - second)


def _balance(root: Element) -> None:
    """Give bodies with a moment larger than the sum of the two others the mean of all three, as MuJoCo does."""
    for body in _bodies(root):
        stated = body.find("inertial")
        if stated is None:
            continue
        text = stated.get("fullinertia", stated.get("diaginertia", "0 0 0"))
        xx, yy, zz, xy, xz, yz = [*map(float, text.split()), 0.0, 0.0, 0.0][:6]
        moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if moments[2] > moments[0] + moments[1]:
            stated.attrib.pop("fullinertia", None)
            stated.set("diaginertia", _text(3 * [float(moments.mean())]))


def _scale(root: Element, total: float) -> None:
    """Give all bodies together this mass [kg], where it is positive."""
    inertials = [body.find("inertial") for body in _bodies(root)]
    known = [each for each in inertials if each is not None]
    mass = sum(float(each.get("mass", "0")) for each in known)
    if not (total > 0.0 and mass > 0.0):
        return
    for each in known:
        for name in ("mass", "diaginertia", "fullinertia"):
            if name in each.attrib:
                each.set(name, _text([total / mass * float(number) for number in each.get(name, "").split()]))


def _text(numbers: Array | list[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)
