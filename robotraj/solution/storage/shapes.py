"""Robots in files: the whole planning model, and the URDF of the shapes."""

from __future__ import annotations

import os
from dataclasses import replace

from robotraj._util.errors import UnknownName, warn
from robotraj.robot.known_robots.catalogue import catalogue, find
from robotraj.robot.loading.geometry import Geometry, NoGeometry, UrdfGeometry
from robotraj.robot.loading.joined import JoinedGeometry
from robotraj.robot.robot import Robot
from robotraj.solution.storage.packing import Packer
from robotraj.solution.storage.plain_data import Json, NotPlainData


def pack_robot(robot: Robot, packer: Packer, path: str) -> tuple[Json, list[str]]:
    """Write a robot; also return the names of shapes that are not plain data, which are not written."""
    try:
        return packer.pack(robot, path), []
    except NotPlainData:
        bare = replace(robot, geometry=NoGeometry())
        return packer.pack(bare, path), [f"the shapes of robot {robot.name!r}, which came with its model"]


def with_shapes(robot: Robot) -> Robot:
    """Find a robot's shapes again: in the URDF they were read from, else in the catalogue's of its name.

    A file widens no path: folders that it names are not searched, and meshes outside the folders of a URDF are trusted
    where it belongs to the catalogue, whatever the file claims. This holds for the parts of a joined robot too.
    """
    return replace(robot, geometry=_found_again(robot.geometry, robot.name))


def _found_again(geometry: Geometry, name: str) -> Geometry:
    if isinstance(geometry, JoinedGeometry):
        parts = tuple(
            replace(part, geometry=_found_again(part.geometry, str(part.model.name))) for part in geometry.parts
        )
        return replace(geometry, parts=parts)
    if not isinstance(geometry, UrdfGeometry):
        return geometry
    known = geometry.urdf in {entry.urdf for entry in catalogue()}
    if known or os.path.isfile(geometry.urdf):
        return UrdfGeometry(geometry.urdf, (), trust_paths=known)
    try:
        return UrdfGeometry(find(name).urdf, (), trust_paths=True)
    except UnknownName:
        warn(f"The URDF of {name!r} is gone ({geometry.urdf}): its shapes are missing, nothing else.")
        return NoGeometry()
