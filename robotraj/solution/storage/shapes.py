"""Robots in files: the whole planning model, and the URDF of the shapes."""

from __future__ import annotations

from dataclasses import replace

from robotraj._util.errors import UnknownName, warn
from robotraj.robot.known_robots.catalogue import catalogue, find
from robotraj.robot.loading.geometry import NoGeometry, UrdfGeometry
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

    Meshes outside the folders of a URDF are trusted where it belongs to the catalogue, whatever the file claims.
    """
    geometry = robot.geometry
    if not isinstance(geometry, UrdfGeometry):
        return robot
    trusted = geometry.urdf in {entry.urdf for entry in catalogue()}
    if geometry.urdf.is_file():
        return replace(robot, geometry=replace(geometry, trust_paths=trusted))
    try:
        return replace(robot, geometry=UrdfGeometry(find(robot.name).urdf, geometry.package_dirs, trust_paths=True))
    except UnknownName:
        warn(f"The URDF of {robot.name!r} is gone ({geometry.urdf}): its shapes are missing, nothing else.")
        return replace(robot, geometry=NoGeometry())
