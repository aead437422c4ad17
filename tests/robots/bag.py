"""A leg of hip, knee and ankle with a flat foot, and a box that hangs behind its body."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import robotraj as rt

BAG = """<robot name="bag">
  <link name="body">
    <inertial><mass value="6"/><origin xyz="0 0 0.2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision name="bag"><origin xyz="-0.12 0 -0.05"/><geometry><box size="0.1 0.1 {bag}"/></geometry></collision>
  </link>
  {links}
</robot>"""
LINK = """<link name="{name}">
    <inertial><mass value="{mass}"/><origin xyz="0 0 {middle}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="{joint}" type="revolute"><parent link="{parent}"/><child link="{name}"/><origin xyz="0 0 {at}"/>
    <axis xyz="0 1 0"/><limit lower="-2.6" upper="2.6" effort="150" velocity="15"/></joint>"""


def bag_robot(folder: Path, bag: float = 0.5) -> rt.Robot:
    """A leg of hip, knee and ankle with a flat foot; a box hangs behind its body, down to ``bag / 2 + 0.05``."""
    links = [("thigh", 1.0, -0.2, "hip", "body", 0.0), ("shank", 1.0, -0.2, "knee", "thigh", -0.4)]
    links += [("foot", 0.5, 0.0, "ankle", "shank", -0.4)]
    names = ("name", "mass", "middle", "joint", "parent", "at")
    parts = "\n  ".join(LINK.format(**dict(zip(names, link, strict=True))) for link in links)
    path = folder / "bag.urdf"
    path.write_text(BAG.format(bag=bag, links=parts))
    return rt.load(path, root="planar")


def crouch(robot: rt.Robot, down: float, pitch: float | None = None) -> rt.Problem:
    """Stand, and crouch until the hip is at a height [m], with any pitch of the body or with the given one [rad]."""
    half = np.arccos(0.78 / 0.8)
    standing = {"root_x": 0, "root_z": 0.78, "root_pitch": 0, "hip": -half, "knee": 2.0 * half, "ankle": -half}
    end = {"root_x": 0, "root_z": down, "knee": 2.0 * float(np.arccos(down / 0.8))}
    if pitch is not None:
        end["root_pitch"] = pitch
    return rt.Problem(
        [
            rt.Phase(
                robot,
                duration=1.0,
                start=rt.State(q=standing, v=0),
                end=rt.State(q=end, v=0),
                contacts=[rt.FlatFoot("foot", (0.1, 0.2), friction=0.8, ground=rt.terrain.Flat())],
                parameters={"foot.x": 0.0},
                objective=rt.Effort(),
            )
        ]
    )
