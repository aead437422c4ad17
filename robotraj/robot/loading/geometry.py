"""Where a robot's visual and collision geometry comes from: it is read when first asked for.

A robot from a URDF pickles without its shapes (19 kB instead of 177 MB for a UR5's meshes), so that planning
starts at once and a robot can be sent to another process, where the shapes are read again if wanted.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.loading.packages import find_mesh, search_folders
from robotraj.robot.loading.urdf import read_xml

Array = npt.NDArray[np.float64]

TAGS = {pin.GeometryType.VISUAL: "visual", pin.GeometryType.COLLISION: "collision"}


class Geometry(Protocol):
    """Gives the shapes that belong to a planning model."""

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Geometry model of the kind for the planning model."""


@dataclass(frozen=True)
class UrdfGeometry(OneLine):
    """Shapes of a URDF; links keep their frames through locking, so they attach to the model by name.

    Attributes
    ----------
    urdf : Path
        The file.
    package_dirs : tuple of str
        Folders given by the caller to look for meshes in, before those found automatically.
    """

    urdf: Path
    package_dirs: tuple[str | os.PathLike[str], ...] = ()

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Read the shapes of one kind; leave out meshes that are not there, with a warning."""
        root = read_xml(self.urdf)
        folders = list(search_folders(self.urdf, self.package_dirs))
        missing: list[str] = []
        for link in root.findall("link"):
            for shape in list(link.findall(TAGS[kind])):
                mesh = shape.find("geometry/mesh")
                if mesh is None:
                    continue
                address = mesh.get("filename", "")
                found = find_mesh(address, self.urdf, folders)
                if found is None:
                    missing.append(f"{address} (link {link.get('name')})")
                    link.remove(shape)
                else:
                    mesh.set("filename", str(found))
        if missing:
            warnings.warn(
                f"{self.urdf.name}: {len(missing)} {TAGS[kind]} mesh(es) not found and left out: "
                f"{', '.join(missing)}. "
                "Name the folder above the package with package_dirs=.",
                stacklevel=3,
            )
        return pin.buildGeomFromUrdfString(model, ElementTree.tostring(root, encoding="unicode"), kind)


@dataclass(frozen=True)
class GivenGeometry:
    """Shapes that came with a RobotWrapper, moved along when joints are locked.

    Attributes
    ----------
    model : pinocchio.Model
        The model they belong to, in angles, before locking.
    visual, collision : pinocchio.GeometryModel
        The shapes.
    locked : tuple of int
        Ids of the joints that the planning model locks.
    q : (nq,) array
        Where it locks them.
    """

    model: pin.Model
    visual: pin.GeometryModel
    collision: pin.GeometryModel
    locked: Sequence[int]
    q: Array

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Copy the shapes of one kind, attached to the planning model's joints."""
        shapes = self.visual if kind == pin.GeometryType.VISUAL else self.collision
        if not self.locked:
            return shapes.copy()
        return pin.buildReducedModel(self.model, shapes, list(self.locked), self.q)[1]


@dataclass(frozen=True)
class NoGeometry:
    """A bare pin.Model has no shapes."""

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Give an empty geometry model."""
        return pin.GeometryModel()
