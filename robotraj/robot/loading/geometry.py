"""Sources of a robot's visual and collision geometry, which is read on first use.

Loading a robot does not wait for meshes. A robot from a URDF is pickled without its shapes. Another process that
receives the robot reads them again on first use.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from copy import deepcopy
from pathlib import Path
from typing import Protocol
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, warn
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.loading.packages import find_mesh, is_inside, search_folders
from robotraj.robot.meshes.placed import unread, with_meshes
from robotraj.robot.meshes.reading import read_meshes
from robotraj.robot.size.reach import reach
from robotraj.robot.urdf.balls import without_balls
from robotraj.robot.urdf.numbers import LARGEST, numbers
from robotraj.robot.urdf.xml import read_xml

TAGS = {pin.GeometryType.VISUAL: "visual", pin.GeometryType.COLLISION: "collision"}

DOUBTED = "of a size that the robot can hardly have: {}. Correct the unit of the file, or scale= of the URDF's <mesh>."
UNREADABLE = "mesh(es) not readable and skipped: {}. Export them again as STL, OBJ or COLLADA."
IMPOSSIBLE = "shape(s) of impossible size, skipped: {}. Correct the URDF."

_closed: ContextVar[bool] = ContextVar("closed", default=False)
HEAD = 65_536
"""Bytes at the beginning of a file in which the unit stands."""
UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']\s*([0-9.eE+-]+)\s*[\"']")
LARGE, SMALL = 30.0, 1e-3
"""Sizes of a mesh relative to the reach of the robot above and below which it is doubted."""
SIZES: Mapping[str, Sequence[tuple[str, int]]] = {
    "box": (("size", 3),),
    "sphere": (("radius", 1),),
    "cylinder": (("radius", 1), ("length", 1)),
    "capsule": (("radius", 1), ("length", 1)),
}
"""Attributes that are sizes [m], and the number of their numbers."""


class ShapesUnread(InputError):
    """Reading shapes from files is not allowed inside ``unread_shapes``."""


@contextmanager
def unread_shapes() -> Iterator[None]:
    """Raise ``ShapesUnread`` instead of reading a URDF or mesh: an untrusted file may have named the path."""
    token = _closed.set(True)
    try:
        yield
    finally:
        _closed.reset(token)


class Geometry(Protocol):
    """A source of the shapes of a planning model."""

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Return the geometry model of the kind for the planning model."""

    def stated(self, kind: pin.GeometryType) -> Counter[str]:
        """Return the number of shapes of the kind that the source states for each link, read or not."""


@dataclass(frozen=True)
class UrdfGeometry(OneLine):
    """Shapes of a URDF, attached by the names of links, whose frames exist also behind locked joints.

    Attributes
    ----------
    urdf : Path
        The file.
    package_dirs : tuple of str
        Absolute folders given by the caller; they are searched for meshes before the URDF's own and its package.
    trust_paths : bool
        Whether meshes anywhere else are read.
    """

    urdf: Path
    package_dirs: tuple[str | os.PathLike[str], ...] = ()
    trust_paths: bool = False

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Return the shapes of one kind; meshes that cannot be read are skipped, with a warning.

        Raises
        ------
        ShapesUnread
            Inside ``unread_shapes``.
        """
        if _closed.get():
            raise ShapesUnread(f"The shapes in {str(self.urdf)!r} are not read while a file is loaded.")
        root, folders = deepcopy(without_balls(self.root)), self._folders()
        faults: dict[str, list[str]] = {}
        for link in root.findall("link"):
            for shape in link.findall(TAGS[kind]):
                if (wrong := impossible_size(shape)) is not None:
                    faults.setdefault(IMPOSSIBLE, []).append(f"link {link.get('name')}: {wrong}")
                    link.remove(shape)
        for link, shape, mesh in list(_meshes(root, kind)):
            address = mesh.get("filename", "")
            found = find_mesh(address, self.urdf, folders)
            if found is not None and (self.trust_paths or is_inside(found, folders)):
                mesh.set("filename", str(found))
                scale_by(mesh, unit_of(found))
            else:
                link.remove(shape)  # ``missing_meshes`` names it when the robot is loaded
        read = read_meshes(Path(mesh.get("filename", "")) for _, _, mesh in _meshes(root, kind))
        for link, shape, mesh in list(_meshes(root, kind)):
            reason = unread(mesh, read[Path(mesh.get("filename", ""))])
            if reason is not None:
                address = f"{mesh.get('filename')} (link {link.get('name')}: {reason})"
                faults.setdefault(UNREADABLE, []).append(address)
                link.remove(shape)
        shapes = with_meshes(model, root, kind, read)
        for fault, addresses in faults.items():
            warn(f"{self.urdf.name}: {len(addresses)} {TAGS[kind]} {fault.format(', '.join(addresses))}")
        doubted = doubted_sizes(model, shapes)
        if doubted:
            warn(f"{self.urdf.name}: {TAGS[kind]} mesh(es) {DOUBTED.format(', '.join(doubted))}")
        return shapes

    def stated(self, kind: pin.GeometryType) -> Counter[str]:
        """Return the number of shapes of the kind for each link, meshes that cannot be read included."""
        if _closed.get():
            raise ShapesUnread(f"The shapes in {str(self.urdf)!r} are not read while a file is loaded.")
        links = self.root.findall("link")
        return Counter({link.get("name", ""): len(link.findall(TAGS[kind])) for link in links})

    @cached_property
    def root(self) -> Element:
        """The URDF, read and its macros expanded once in a process: shapes belong to the model that was loaded."""
        return read_xml(self.urdf, folders=self._folders(), trust=self.trust_paths)

    def _folders(self) -> list[Path]:
        return search_folders(self.urdf, self.package_dirs, self.trust_paths)


def _meshes(root: Element, kind: pin.GeometryType) -> Iterator[tuple[Element, Element, Element]]:
    """Yield each link, its shape of the kind and the shape's mesh."""
    for link in root.findall("link"):
        for shape in link.findall(TAGS[kind]):
            mesh = shape.find("geometry/mesh")
            if mesh is not None:
                yield link, shape, mesh


@dataclass(frozen=True)
class GivenGeometry:
    """Shapes that came with a RobotWrapper, moved along when joints are locked.

    Attributes
    ----------
    model : pinocchio.Model
        The model of the shapes, in angles, before joints are locked.
    visual, collision : pinocchio.GeometryModel
        The shapes.
    locked : tuple of int
        Ids of the joints that the planning model locks.
    q : (nq,) array
        Configuration at which they are locked.
    """

    model: pin.Model
    visual: pin.GeometryModel
    collision: pin.GeometryModel
    locked: Sequence[int]
    q: Array

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Copy the shapes of one kind, attached to the planning model's joints."""
        shapes = self.visual if kind == pin.GeometryType.VISUAL else self.collision
        locked = list(self.locked)
        made = pin.buildReducedModel(self.model, shapes, locked, self.q)[1] if locked else shapes.copy()
        for shape in made.geometryObjects:
            # Leaders stand before their followers in the planning model; frames keep their order.
            shape.parentJoint = model.frames[shape.parentFrame].parentJoint
        return made

    def stated(self, kind: pin.GeometryType) -> Counter[str]:
        """Return the number of shapes of the kind on each link."""
        shapes = self.visual if kind == pin.GeometryType.VISUAL else self.collision
        return Counter(self.model.frames[shape.parentFrame].name for shape in shapes.geometryObjects)


@dataclass(frozen=True)
class NoGeometry:
    """A bare pin.Model has no shapes."""

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Return an empty geometry model."""
        return pin.GeometryModel()

    def stated(self, kind: pin.GeometryType) -> Counter[str]:
        """Return no shapes."""
        return Counter()


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


def impossible_size(shape: Element) -> str | None:
    """Return what is wrong with the sizes of a <visual> or <collision>; None for a mesh and for sizes of a shape."""
    for kind, keys in SIZES.items():
        for element in shape.findall(f"geometry/{kind}"):
            for key, count in keys:
                text = element.get(key, "")
                sizes = numbers(text, count)
                if sizes is None or not all(0.0 <= size <= LARGEST for size in sizes):
                    what = "numbers" if count > 1 else "number"
                    return f"{key}={text[:40]!r} of its {kind} is not {count} {what} from 0 to {LARGEST:g} m"
    return None
