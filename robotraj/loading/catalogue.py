"""The robots that can be loaded by name."""

from __future__ import annotations

from robotraj.errors import unknown_name
from robotraj.loading.entry import Entry
from robotraj.loading.example_robots import example_robots
from robotraj.loading.own_robots import own_robots


def catalogue() -> tuple[Entry, ...]:
    """List every robot known by name: robotraj's own first, then example-robot-data's; own names win."""
    own = own_robots()
    others = [entry for name, entry in sorted(example_robots().items()) if name not in own]
    return (*own.values(), *others)


def find(name: str) -> Entry:
    """Look a robot up by name.

    Raises
    ------
    UnknownName
        Lists the nearest names.
    """
    entries = {entry.name: entry for entry in catalogue()}
    if name not in entries:
        raise unknown_name("robot", name, entries, "Or give the path of a URDF file.")
    return entries[name]
