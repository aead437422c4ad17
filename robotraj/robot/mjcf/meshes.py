"""A copy of an MJCF file whose meshes are plain triangles beside it.

Pinocchio's reader opens whatever the meshes name, has no limits, and is another parser of XML. It is given this copy.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.robot.collision.tessellation import hull_triangles
from robotraj.robot.loading.packages import is_inside
from robotraj.robot.meshes.arrays import MeshArrays
from robotraj.robot.meshes.reading import read_meshes
from robotraj.robot.mjcf.placement import Placement

STL = np.dtype([("corners", "<f4", (4, 3)), ("attributes", "<u2")])
"""A triangle of a binary STL: normal and corners."""
REFERENCES = {"pos": "refpos", "quat": "refquat"}
"""Attributes of the pose in whose axes the vertices of a mesh are meant."""


class PlainCopy:
    """The copy, in a folder of its own.

    Parameters
    ----------
    root : Element
        The file; its meshes are renamed.
    path : Path
        Place of the file.
    folders : sequence of Path or None
        Folders whose meshes are read; None for all.
    place : Path
        The folder.

    Attributes
    ----------
    meshes : dict of str to MeshArrays
        The meshes by name, in the axes of their references, without their scales.

    Raises
    ------
    InputError
        A mesh lies elsewhere, or cannot be read within the limits of meshes.
    """

    def __init__(self, root: Element, path: Path, folders: Sequence[Path] | None, place: Path) -> None:
        self.file = place / path.name
        self.meshes: dict[str, MeshArrays] = {}
        self._root, self._sources = root, dict[str, str]()
        compilers = list(root.iter("compiler"))
        given = {name: value for compiler in compilers for name, value in compiler.attrib.items()}
        folder = path.parent / (given.get("meshdir") or given.get("assetdir") or "")
        stripped = given.get("strippath") == "true"
        meshes = [mesh for mesh in root.iter("mesh") if mesh.get("file")]
        names = [mesh.get("file", "").replace("\\", "/") for mesh in meshes]
        files = [folder / (Path(name).name if stripped else name) for name in names]
        outside = [file for file in files if folders is not None and not is_inside(file, folders)]
        if outside:
            raise InputError(
                f"{str(path)!r}: the mesh {str(outside[0])!r} lies outside the folder of the file; package_dirs= with "
                "its folder or trust_paths=True reads it."
            )
        read = read_meshes(files)
        for number, (mesh, file) in enumerate(zip(meshes, files, strict=True)):
            found = read[file]
            if isinstance(found, str):
                raise InputError(f"{str(path)!r}: the mesh {str(file)!r} cannot be read: {found}.")
            plain, moved = place / f"{number}.stl", _moved(mesh, found)
            plain.write_bytes(_stl(moved))
            self._sources[str(plain)] = str(file) if moved is found else ""
            mesh.set("name", mesh.get("name") or file.stem)
            mesh.set("file", str(plain))
            self.meshes[mesh.get("name", "")] = moved
        for number, mesh in enumerate(mesh for mesh in root.iter("mesh") if mesh.get("vertex")):
            plain = place / f"stated{number}.stl"
            stated = self.meshes[mesh.get("name", "")] = _moved(mesh, _stated(mesh, str(path)))
            plain.write_bytes(_stl(stated))
            self._sources[str(plain)] = ""
            mesh.set("file", str(plain))
            for name in ("vertex", "face", "normal", "texcoord"):
                mesh.attrib.pop(name, None)
        for compiler in compilers:
            for name in ("meshdir", "assetdir", "strippath"):
                compiler.attrib.pop(name, None)

    def write(self) -> None:
        """Write the file as it is now."""
        ElementTree.ElementTree(self._root).write(self.file, encoding="utf-8")

    def name_sources(self, shapes: pin.GeometryModel) -> None:
        """Give shapes the paths of the files whose meshes they are, none where vertices are stated or moved."""
        for shape in shapes.geometryObjects:
            shape.meshPath = self._sources.get(shape.meshPath, shape.meshPath)


def _moved(mesh: Element, read: MeshArrays) -> MeshArrays:
    """Return a mesh in the axes of its ``refpos`` and ``refquat``, which Pinocchio's reader ignores.

    MuJoCo's scale acts after them.
    """
    given = {key: mesh.attrib.pop(name) for key, name in REFERENCES.items() if name in mesh.attrib}
    if not given:
        return read
    place = Placement(Element("mujoco")).of(given)
    return MeshArrays((read.vertices - place.translation) @ place.rotation, read.triangles)


def _stated(mesh: Element, file: str) -> MeshArrays:
    """Return the mesh whose vertices the file states: its faces, or the hull of the vertices.

    coal ends the process on hulls of points in a plane.

    Raises
    ------
    InputError
        It is no mesh.
    """
    try:
        points = np.array(mesh.get("vertex", "").split(), dtype=float).reshape(-1, 3)
        faces = np.array(mesh.get("face", "").split(), dtype=np.int32).reshape(-1, 3)
        if not len(faces):
            corners = hull_triangles(np.unique(points, axis=0)).reshape(-1, 3)
            points, faces = corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
        return MeshArrays(points, faces)
    except ValueError as error:
        raise InputError(
            f"{file!r}: the vertices of the mesh {mesh.get('name', '')[:60]!r} are none: {error}."
        ) from error


def _stl(mesh: MeshArrays) -> bytes:
    corners = mesh.vertices[mesh.triangles]
    triangles = np.zeros(len(corners), STL)
    triangles["corners"][:, 0] = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles["corners"][:, 1:] = corners
    return bytes(80) + np.uint32(len(corners)).tobytes() + triangles.tobytes()
