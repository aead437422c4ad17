"""The robots that can be loaded by name."""

from __future__ import annotations

from robotraj._util.errors import unknown_name
from robotraj.robot.known_robots.entry import KnownRobot
from robotraj.robot.known_robots.example_robots import example_robot, example_robots
from robotraj.robot.known_robots.own_robots import own_robot, own_robots


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
