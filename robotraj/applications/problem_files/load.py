"""``load_problem``: read a problem from a TOML file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.applications.problem_files.bounds import MOST_INTERVALS, MOST_PHASES
from robotraj.applications.problem_files.kinds import GAITS
from robotraj.applications.problem_files.lines import Data, KeyPath, Misplaced
from robotraj.applications.problem_files.narrowing import narrowed
from robotraj.applications.problem_files.parameters import parameters_of
from robotraj.applications.problem_files.reader import Reader
from robotraj.applications.problem_files.robots import robots_of
from robotraj.applications.problem_files.toml_file import read_toml
from robotraj.planning.plan import plan
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.replay_page.options import ReplayOptions, check_options
from robotraj.replay_page.write import replay
from robotraj.robot.robot import Robot
from robotraj.solution.solution import Solution
from robotraj.solvers.checks import above_zero
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.witness.validation import ValidationOptions, validate

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import PlanOptions
    from robotraj.problem.links.base import Link
    from robotraj.replay_page.options import ReplayOptions
    from robotraj.witness.validation import ValidationOptions


@dataclass(frozen=True, eq=False)
class ProblemFile(OneLine):
    """What ``rt.load_problem`` read.

    Attributes
    ----------
    path : Path
        The file, absolute.
    problem : Problem
    options : mapping
        Options of ``rt.plan``: the table ``[plan]``.
    validation, replay : mapping
        Options of ``rt.validate`` and ``rt.replay``: the tables ``[validate]`` and ``[replay]``.
    output : mapping of str to Path
        Files to be written, ``"html"``, ``"save"`` and ``"plot"``: the table ``[output]``.
    """

    path: Path
    problem: Problem
    options: PlanOptions
    validation: ValidationOptions
    replay: ReplayOptions
    output: Mapping[str, Path]

    def plan(self, **options: Unpack[PlanOptions]) -> Solution:
        """Plan the motion, ``rt.plan(file.problem, **file.options)``; the options given here precede the file's."""
        merged: PlanOptions = {**self.options, **options}
        return plan(self.problem, **merged)

    def __str__(self) -> str:
        return str(self.problem)


TABLES = ("robot", "robots", "define", "phases", "links", "gait", "plan", "validate", "replay", "output")
OUTPUTS = ("html", "save", "plot")
OF_CALLERS = ("problem", "settings", "check", "progress", "watch", "keep_program", "continuation")
"""Parameters of ``rt.plan`` that a file does not set."""
FROM_CALLS = ("solution", "path", "report", "curves", "measured")
"""Parameters of ``rt.replay`` that a file does not set."""


def load_problem(path: str | os.PathLike[str]) -> ProblemFile:
    """Read a problem, the options of its plan and the files that it writes.

    The tables of the file mirror the classes and functions of robotraj; ``docs/problem-files.md`` explains them, and
    ``robotraj schema`` prints them. ``robotraj init`` writes a first file.

    Parameters
    ----------
    path : path
        A TOML file. Relative paths in it start at its folder.

    Returns
    -------
    ProblemFile
        ``file.plan()`` plans the motion.

    Raises
    ------
    InputError
        There is no such file, it is no TOML, or a value is invalid; the message names line and key.

    Examples
    --------
    >>> file = load_problem("problem.toml")
    >>> solution = file.plan()
    """
    file = read_toml(path, "The problem file")
    with file.placed():
        return _read(file.source, file.data)


def _read(source: Path, data: Mapping[str, Data]) -> ProblemFile:
    for key in data:
        if key not in TABLES:
            raise Misplaced((key,), str(unknown_name("table", key, TABLES)))
    defined = _table(data, "define")
    reader = Reader(source.parent, defined, {})
    robots = robots_of(data, reader)
    reader = replace(reader, robots=robots)
    if "phases" in data and "gait" in data:
        raise Misplaced(("gait",), "a problem has either [[phases]] or a [gait]; remove one of them.")
    if "phases" not in data and "gait" not in data:
        raise Misplaced((), "states no motion: add [[phases]] with duration, start and end, or a [gait].")
    problem = _gait(_table(data, "gait"), reader, robots) if "gait" in data else _problem(data, reader, robots)
    only = next(iter(robots.values())) if len(robots) == 1 else None
    reader = replace(reader, robot=only)
    return ProblemFile(
        source,
        problem,
        narrowed(lambda table: _plan(table, reader), _table(data, "plan"), ("plan",)),
        cast(
            "ValidationOptions",
            reader.arguments(validate, _table(data, "validate"), ("validate",), without=("solution",)),
        ),
        narrowed(lambda table: _replay(table, reader), _table(data, "replay"), ("replay",)),
        _output(_table(data, "output"), source.parent),
    )


def _plan(table: dict[str, Data], reader: Reader) -> PlanOptions:
    """Read the options of ``rt.plan`` and check its limits before the plan."""
    options = cast("PlanOptions", reader.arguments(plan, table, ("plan",), without=OF_CALLERS))
    if options.get("time_limit") is not None:
        above_zero("time_limit", options["time_limit"], "s")
    if options.get("memory_limit") is not None:
        above_zero("memory_limit", options["memory_limit"], "MB")
    mesh = options.get("mesh")
    for each in mesh if isinstance(mesh, Sequence) else [mesh]:
        count = len(each.knots) - 1 if isinstance(each, Mesh) else 0
        if count > MOST_INTERVALS:
            raise InputError(f"mesh has {count} intervals; a file has at most {MOST_INTERVALS} for a phase.")
    return options


def _replay(table: dict[str, Data], reader: Reader) -> ReplayOptions:
    """Read the options of ``rt.replay`` and check what can be checked before the plan."""
    options = cast("ReplayOptions", reader.arguments(replay, table, ("replay",), without=FROM_CALLS))
    for robot in reader.robots.values():
        check_options(robot, options.get("speed", 1.0), options.get("fps", 30), options.get("traces"))
    return options


def _table(data: Mapping[str, Data], name: str) -> dict[str, Data]:
    table = data.get(name, {})
    if not isinstance(table, dict):
        raise Misplaced((name,), f"is a table, [{name}]; got {table!r}.")
    return table


def _robot(data: dict[str, Data], place: KeyPath, robots: Mapping[str, Robot]) -> tuple[Robot, dict[str, Data]]:
    """Return the robot of a phase or gait, and its data without the robot."""
    rest = {key: entry for key, entry in data.items() if key != "robot"}
    name = data.get("robot")
    if name is None:
        if len(robots) != 1:
            raise Misplaced(place, f"names its robot: robot = one of {', '.join(map(repr, robots))}.")
        return next(iter(robots.values())), rest
    if name not in robots:
        raise Misplaced((*place, "robot"), str(unknown_name("robot", name, robots)))
    return robots[name], rest


def _problem(data: Mapping[str, Data], reader: Reader, robots: Mapping[str, Robot]) -> Problem:
    stated = data["phases"]
    if not isinstance(stated, list) or not all(isinstance(each, dict) for each in stated):
        raise Misplaced(("phases",), "is a list of tables, [[phases]].")
    if len(stated) > MOST_PHASES:
        raise Misplaced(("phases",), f"has {len(stated)} phases; a file has at most {MOST_PHASES}.")
    phases = [_phase(each, ("phases", i), reader, robots) for i, each in enumerate(stated)]
    accepted = parameters_of(Problem)["links"].accepted

    def make(data: Data) -> Problem:
        return Problem(phases, cast("Sequence[Link]", reader.value(data, accepted, ("links",))))

    return narrowed(make, data.get("links", []), ("links",) if "links" in data else ("phases",))


def _phase(data: dict[str, Data], place: KeyPath, reader: Reader, robots: Mapping[str, Robot]) -> Phase:
    robot, rest = _robot(data, place, robots)
    own = reader.for_robot(robot)

    def make(data: Data) -> Phase:
        return Phase(robot, **own.arguments(Phase, data, place, without=("subject",)))

    return narrowed(make, rest, place)


def _gait(data: dict[str, Data], reader: Reader, robots: Mapping[str, Robot]) -> Problem:
    place: KeyPath = ("gait",)
    robot, rest = _robot(data, place, robots)
    own, name = reader.for_robot(robot), data.get("type")
    write = GAITS.get(name) if isinstance(name, str) else None
    if write is None:
        raise Misplaced((*place, "type") if "type" in data else place, str(unknown_name("gait", name, GAITS)))

    def make(data: Data) -> Problem:
        return cast("Problem", write(robot, **own.arguments(write, data, place, without=("robot",))))

    return narrowed(make, rest, place)


def _output(data: dict[str, Data], folder: Path) -> dict[str, Path]:
    for key, value in data.items():
        if key not in OUTPUTS:
            raise Misplaced(("output", key), str(unknown_name("output", key, OUTPUTS)))
        if not isinstance(value, str):
            raise Misplaced(("output", key), f"is the path of a file; got {value!r}.")
    return {key: folder / value for key, value in data.items()}
