"""Robots of a file: loaded, joined to others, on wheels, and carrying bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

from robotraj._util.errors import unknown_name
from robotraj.applications.problem_files.bounds import MOST_ROBOTS
from robotraj.applications.problem_files.kinds import KINDS
from robotraj.applications.problem_files.lines import Data, KeyPath, Misplaced
from robotraj.applications.problem_files.narrowing import narrowed
from robotraj.applications.problem_files.parameters import Maker, parameters_of
from robotraj.applications.problem_files.reader import Reader
from robotraj.robot.carried_body import CarriedBody, carrying
from robotraj.robot.join import join
from robotraj.robot.load import load
from robotraj.robot.mobile import on_rail, on_wheels
from robotraj.robot.robot import Robot

MAKERS: Mapping[str, Maker] = {"load": load, "join": join, "on_wheels": on_wheels, "on_rail": on_rail}
"""Functions of ``rt.robot`` that ``type = "..."`` of a robot may name; ``load`` is the default."""

_BODIES = parameters_of(KINDS["PayloadScenarios"])["payloads"].accepted


def robots_of(data: Mapping[str, Data], reader: Reader) -> dict[str, Robot]:
    """Return the robots of the tables ``[robot]``, whose name is ``"robot"``, and ``[robots.NAME]``.

    Raises
    ------
    Misplaced
        There is none, or one cannot be made.
    """
    tables: list[tuple[str, KeyPath, Data]] = [("robot", ("robot",), data["robot"])] if "robot" in data else []
    several = data.get("robots", {})
    if not isinstance(several, dict):
        raise Misplaced(("robots",), "is a table of robots by name, [robots.NAME].")
    tables += [(name, ("robots", name), entry) for name, entry in several.items()]
    if len(tables) > MOST_ROBOTS:
        raise Misplaced(("robots",), f"has {len(tables)} robots; a file has at most {MOST_ROBOTS}.")
    if not tables:
        raise Misplaced((), 'names no robot: add [robot] with source = "a name or a URDF file".')
    robots: dict[str, Robot] = {}
    for name, place, table in tables:
        if not isinstance(table, dict):
            raise Misplaced(place, f'is a table such as {{ source = "ur5" }}; got {table!r}.')
        robots[name] = _robot(table, place, Reader(reader.folder, reader.defined, dict(robots)))
    return robots


def _robot(data: dict[str, Data], place: KeyPath, reader: Reader) -> Robot:
    kind = data.get("type", "load")
    if kind not in MAKERS:
        raise Misplaced((*place, "type"), str(unknown_name("function of rt.robot", kind, MAKERS)))
    rest = {key: entry for key, entry in data.items() if key != "payload"}
    made = MAKERS[kind]
    robot = cast("Robot", narrowed(lambda data: made(**reader.arguments(made, data, place)), rest, place))
    if "payload" not in data:
        return robot
    several = data["payload"] if isinstance(data["payload"], list) else [data["payload"]]

    def carry(data: Data) -> Robot:
        return carrying(robot, *cast("Sequence[CarriedBody]", reader.value(data, _BODIES, (*place, "payload"))))

    return narrowed(carry, several, (*place, "payload"))
