"""The robots of both tools: Crocoddyl's talos_legs is its pelvis and legs alone, without the torso's mass."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from importlib.metadata import distribution
from pathlib import Path

import robotraj as rt


def robot_of(name: str) -> rt.Robot:
    """Load a robot as Crocoddyl has it."""
    if name != "talos_legs":
        return rt.load(name, root="floating")
    share = distribution("example-robot-data").locate_file("cmeel.prefix/share/example-robot-data/robots")
    tree = ET.parse(Path(str(share)) / "talos_data/robots/talos_reduced.urdf")
    root = tree.getroot()
    joints = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    for link in [link for link in root.findall("link") if not _kept(link.get("name"), joints)]:
        root.remove(link)
        if link.get("name") in joints:
            root.remove(joints[link.get("name")])
    kept = {link.get("name") for link in root.findall("link")}
    for link in root.findall("link"):
        for kind in ("visual", "collision"):
            for shape in link.findall(kind):
                link.remove(shape)
    for kind in ("transmission", "gazebo"):
        for part in root.findall(kind):
            root.remove(part)
    assert all(joint.find("parent").get("link") in kept for joint in root.findall("joint"))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.urdf"
        tree.write(path)
        return rt.load(path, root="floating")


def _kept(link: str, joints: dict[str, ET.Element]) -> bool:
    """Whether a link is part of the pelvis or of a leg."""
    while link in joints:
        joint = joints[link]
        if joint.get("type") not in ("fixed", "floating") and not joint.get("name").startswith("leg_"):
            return False
        link = joint.find("parent").get("link")
    return True
