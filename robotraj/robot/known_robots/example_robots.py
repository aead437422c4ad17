"""The robots of example-robot-data 6.0.0, which ships URDFs and SRDFs without a list of their names."""

from __future__ import annotations

import csv
import sys
from functools import lru_cache
from pathlib import Path

from robotraj.robot.known_robots.entry import KnownRobot

SHARE = Path("cmeel.prefix/share/example-robot-data/robots")

TABLE = Path(__file__).with_name("example_robots.csv")
"""One line per robot: name, URDF, SRDF (may be empty), end effector (may be empty), description."""

MOVING = {"talos_legs": ("leg_",)}
"""Robots of which only some joints move: beginnings of their names."""


def folder() -> Path | None:
    """Folder of the package's robots, or None when example-robot-data is not installed."""
    installed = (Path(entry) / SHARE for entry in sys.path)
    return next((path for path in installed if path.is_dir()), None)


@lru_cache(maxsize=1)
def example_robots() -> dict[str, KnownRobot]:
    """Return the catalogue's entries whose URDF is installed."""
    entries = (example_robot(row["name"]) for row in csv.DictReader(_lines()))
    return {entry.name: entry for entry in entries if entry is not None}


@lru_cache(maxsize=64)
def example_robot(name: str) -> KnownRobot | None:
    """Return the entry of that name, if it is in the table and its URDF is installed."""
    robots, row = folder(), _row(name)
    if robots is None or row is None:
        return None
    urdf = robots / row["urdf"]
    package = row["urdf"].split("/")[0]
    if not urdf.is_file():
        return None
    return KnownRobot(
        name,
        row["description"],
        "example-robot-data",
        urdf,
        robots / package / "srdf" / f"{row['srdf']}.srdf" if row["srdf"] else None,
        moving=MOVING.get(name, ()),
        end_effector=row["end_effector"] or None,
        licence=f"see example-robot-data, robots/{package}",
        provenance="example-robot-data 6.0.0",
    )


def _row(name: str) -> dict[str, str] | None:
    """Read the line of the table that begins with the name."""
    header, *lines = _lines()
    return next(csv.DictReader([header, *(line for line in lines if line.startswith(f"{name},"))]), None)


@lru_cache(maxsize=1)
def _lines() -> list[str]:
    return TABLE.read_text(encoding="utf-8").splitlines()
