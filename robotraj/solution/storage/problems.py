"""Problems in files: everything of them that is plain data, and by name what is not.

Functions that the user wrote in Python (a System's equations, expressions of constraints and objectives)
cannot be stored safely; a problem loaded without them is enough to look at, sample and plot.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Any

from robotraj._util.errors import InputError
from robotraj.dynamics.missing import MissingEquations
from robotraj.dynamics.system import System
from robotraj.dynamics.variable import Variable
from robotraj.problem.objectives.base import Objective, Sum
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.solution.storage.codec import NotPlainData, Packer, Unpacker
from robotraj.solution.storage.shapes import pack_robot, with_shapes

GROUPS = ("states", "algebraic", "controls")


def pack_problem(problem: Problem, packer: Packer) -> dict[str, Any]:
    """Write a problem; ``"left_out"`` lists what could not be written."""
    left_out: list[str] = list(problem.missing)
    robots: list[Robot] = []
    phases = []
    for i, phase in enumerate(problem.phases):
        if phase.robot is not None and not any(phase.robot is known for known in robots):
            robots.append(phase.robot)
        number = next((n for n, known in enumerate(robots) if known is phase.robot), None)
        phases.append(_pack_phase(phase, number, packer, f"problem.phases.{i}", left_out))
    packed = [pack_robot(robot, packer, f"robots.{n}") for n, robot in enumerate(robots)]
    links = _pack_each(problem.links, packer, "problem.links", "link {}", left_out)
    return {
        "robots": [data for data, _ in packed],
        "phases": phases,
        "links": links,
        "left_out": [*left_out, *(name for _, missing in packed for name in missing)],
    }


def unpack_problem(data: Mapping[str, Any], unpacker: Unpacker) -> tuple[Problem, list[str]]:
    """Make the problem again, as far as it was written; also return what is missing of it."""
    left_out = list(data["left_out"])
    robots = [with_shapes(unpacker.unpack(robot)) for robot in data["robots"]]
    phases = [_unpack_phase(phase, robots, unpacker, left_out) for phase in data["phases"]]
    links = _unpack_each(data["links"], unpacker, left_out)
    return Problem(phases, links, missing=tuple(left_out)), left_out


def check_fit(problem: Problem, data: Mapping[str, Any], name: str) -> None:
    """Raise InputError unless the file's trajectories belong to a problem of these phases and variables."""
    if len(problem.phases) != len(data["phases"]):
        raise InputError(f"{name} has {len(data['phases'])} phases, but problem= has {len(problem.phases)}.")
    for phase, stored in zip(problem.phases, data["phases"], strict=True):
        for group in GROUPS:
            names = [variable.name for variable in getattr(phase.body, group)]
            known = [variable["name"] for variable in stored["variables"][group]]
            if names != known:
                raise InputError(
                    f"{name} is of another problem: its phase {stored['fields']['name']!r} has the {group} "
                    f"{known}, phase {phase.name!r} of problem= has {names}."
                )


def _pack_field(phase: Phase, name: str, packer: Packer, path: str) -> Any:
    """Write a field without which a phase is another; a contact's ground may be a Python function, which cannot be."""
    try:
        return packer.pack(getattr(phase, name), path)
    except NotPlainData as error:
        if name != "contacts":
            raise
        raise InputError(
            f"Phase {phase.name!r} cannot be saved: a contact of {', '.join(repr(c.label) for c in phase.contacts)} "
            "stands on a Python function, which a file does not hold; sample it with "
            "rt.terrain.HeightMap.from_array, or use "
            "rt.terrain.Flat, rt.terrain.Slope or rt.terrain.Steps."
        ) from error


def _pack_phase(phase: Phase, robot: int | None, packer: Packer, path: str, left_out: list[str]) -> dict[str, Any]:
    whose = f"of phase {phase.name!r}"
    system = phase.system
    if system is not None:
        left_out.append(f"the equations of system {system.name!r}")
    plain = {}
    for entry in fields(phase):
        if entry.name not in ("subject", "constraints", "objective"):
            plain[entry.name] = _pack_field(phase, entry.name, packer, f"{path}.{entry.name}")
    terms = phase.objective.terms if phase.objective is not None else ()
    return {
        "robot": robot,
        "system": None if system is None else system.name,
        "variables": {
            group: [{"name": v.name, "unit": v.unit} for v in getattr(phase.body, group)] for group in GROUPS
        },
        "fields": plain,
        "constraints": _pack_each(
            phase.constraints, packer, f"{path}.constraints", f"constraint {{}} {whose}", left_out
        ),
        "objective": _pack_each(terms, packer, f"{path}.objective", f"objective {{}} {whose}", left_out),
    }


def _unpack_phase(data: Mapping[str, Any], robots: Sequence[Robot], unpacker: Unpacker, left_out: list[str]) -> Phase:
    plain = {name: unpacker.unpack(entry) for name, entry in data["fields"].items()}
    subject = robots[data["robot"]] if data["robot"] is not None else _system(data["system"], data["variables"])
    terms = _unpack_each(data["objective"], unpacker, left_out)
    objective: Objective | None = Sum(tuple(terms)) if terms else None
    if len(terms) == 1 and terms[0][0] == 1.0:
        objective = terms[0][1]
    constraints = _unpack_each(data["constraints"], unpacker, left_out)
    known = {entry.name for entry in fields(Phase) if entry.init}
    required = {e.name for e in fields(Phase) if e.default is MISSING and e.default_factory is MISSING}
    if not set(plain) <= known or not required <= {*plain, "subject"}:
        raise NotPlainData(f"The fields of its phases are {sorted(plain)}; here a phase has {sorted(known)}.")
    return Phase(subject, **plain, constraints=constraints, objective=objective)


def _system(name: str, variables: Mapping[str, Sequence[Mapping[str, str]]]) -> System:
    """Make a System of the right variables whose equations say that they are missing."""
    groups = {group: [Variable(entry["name"], entry["unit"]) for entry in variables[group]] for group in GROUPS}
    missing = MissingEquations(name)
    return System(
        [v.name for v in groups["states"]],
        [v.name for v in groups["controls"]],
        missing,
        algebraic=[v.name for v in groups["algebraic"]],
        residual=missing if groups["algebraic"] else None,
        units={v.name: v.unit for group in groups.values() for v in group},
        name=name,
    )


def _pack_each(
    values: Sequence[Any], packer: Packer, path: str, described: str, left_out: list[str]
) -> list[dict[str, Any]]:
    """Write what can be written, each with its name for people; name the others in ``left_out``."""
    written = []
    for i, value in enumerate(values):
        name = described.format(_printed(value))
        try:
            written.append({"name": name, "value": packer.pack(value, f"{path}.{i}")})
        except NotPlainData:
            left_out.append(name)
    return written


def _unpack_each(data: Sequence[Mapping[str, Any]], unpacker: Unpacker, left_out: list[str]) -> list[Any]:
    values = []
    for entry in data:
        try:
            values.append(unpacker.unpack(entry["value"]))
        except NotPlainData as error:
            left_out.append(f"{entry['name']} ({error})")
    return values


def _printed(value: Any) -> str:
    """Print a constraint, link or weighted term without addresses in memory."""
    if isinstance(value, tuple):
        weight, term = value
        return _printed(term) if weight == 1 else f"{weight:g} {_printed(term)}"
    text = re.sub(r"<([\w.]+) object at 0x[0-9a-f]+>", r"\1", repr(value))
    text = re.sub(r"<function (\S+) at 0x[0-9a-f]+>", r"\1", text)
    text = re.sub(r"<bound method (\S+) of [^>]*>", r"\1", text)
    text = re.sub(r"<built-in function (\S+)>", r"\1", text)
    return re.sub(r"[\w.]*<locals>\.", "", text)
