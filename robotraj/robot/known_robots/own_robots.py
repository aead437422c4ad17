"""The robots that ship with robotraj: one folder each in robots/, with a URDF and a robot.json beside it."""

from __future__ import annotations

import json
import os
from functools import lru_cache
from pathlib import Path

from robotraj.robot.known_robots.entry import KnownRobot


def folder() -> Path:
    """Folder of the robots: inside the package when installed, beside it in a checkout."""
    package = str(Path(__file__).resolve().parents[2])
    installed = os.path.join(package, "robots")
    return Path(installed if os.path.isdir(installed) else os.path.join(os.path.dirname(package), "robots"))


@lru_cache(maxsize=1)
def own_robots() -> dict[str, KnownRobot]:
    """Read every robots/<name>/robot.json."""
    names = sorted(path.parent.name for path in folder().glob("*/robot.json"))
    return {name: entry for name in names if (entry := own_robot(name)) is not None}


@lru_cache(maxsize=64)
def own_robot(name: str) -> KnownRobot | None:
    """Read robots/<name>/robot.json, where it is; the URDF beside it is <name>.urdf."""
    path = folder() / name / "robot.json"
    if Path(name).name != name or not os.path.isfile(path):
        return None
    about = json.loads(path.read_text(encoding="utf-8"))
    return KnownRobot(
        name,
        about["description"],
        "robots/",
        path.parent / f"{name}.urdf",
        actuated=tuple(about["actuated"]),
        end_effector=about["end_effector"],
        licence=about["licence"],
        provenance=about["provenance"],
    )
