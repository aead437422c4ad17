"""The robots that can be loaded by name."""

from __future__ import annotations

import json
import os
from functools import lru_cache
from pathlib import Path

from robotraj._util.errors import unknown_name
from robotraj.robot.known_robots.entry import KnownRobot
from robotraj.robot.known_robots.example_robots import example_robot, example_robots


def catalogue() -> tuple[KnownRobot, ...]:
    """List every robot known by name: robotraj's first, which take precedence, then example-robot-data's."""
    own = own_robots()
    others = [entry for name, entry in sorted(example_robots().items()) if name not in own]
    return (*own.values(), *others)


def find(name: str) -> KnownRobot:
    """Look a robot up by name.

    Raises
    ------
    UnknownName
        Lists the nearest names.
    """
    entry = own_robot(name) or example_robot(name)
    if entry is None:
        raise unknown_name("robot", name, [known.name for known in catalogue()], "Or give the path of a URDF file.")
    return entry


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
