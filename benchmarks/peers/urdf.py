"""Writes the URDFs that every tool reads: without shapes, and with the panda's fingers fixed."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib.metadata import distribution
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROBOTS = HERE.parents[1] / "robots"
PUBLISHED = {"ur5": "ur_description/urdf/ur5_robot.urdf", "panda": "panda_description/urdf/panda.urdf"}


def source(name: str) -> Path:
    """Where a robot is described."""
    if name in PUBLISHED:
        share = distribution("example-robot-data").locate_file("cmeel.prefix/share/example-robot-data/robots")
        return Path(str(share)) / PUBLISHED[name]
    own = ROBOTS / name / f"{name}.urdf"
    return own if own.exists() else HERE / f"{name}.urdf"


def write(name: str, folder: Path) -> Path:
    """Write a robot's joints and inertias, and nothing else, into a folder."""
    tree = ET.parse(source(name))
    root = tree.getroot()
    for kind in ("transmission", "gazebo", "material"):
        for part in root.findall(kind):
            root.remove(part)
    for link in root.findall("link"):
        for kind in ("visual", "collision"):
            for shape in link.findall(kind):
                link.remove(shape)
    for joint in root.findall("joint"):
        if "finger" in joint.get("name", ""):
            joint.set("type", "fixed")
            for kind in ("mimic", "limit", "dynamics", "axis"):
                for part in joint.findall(kind):
                    joint.remove(part)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.urdf"
    tree.write(path)
    return path
