"""Problems in files: their plain data, and the names of their other parts.

Functions that the user wrote in Python (a System's equations, expressions of constraints and objectives) cannot be
stored safely. A problem loaded without them is enough to look at, sample and plot.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import TypeVar

from robotraj._util.errors import InputError, UnknownName, warn
from robotraj.dynamics.contacts.base import Contact
from robotraj.dynamics.system import MissingEquations, System
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Variable
from robotraj.problem.objectives.base import Objective, Sum
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.known_robots.catalogue import catalogue, find
from robotraj.robot.loading.geometry import Geometry, NoGeometry, UrdfGeometry, unread_shapes
from robotraj.robot.loading.joined import JoinedGeometry
from robotraj.robot.robot import Robot
from robotraj.solution.storage.classes import mismatch
from robotraj.solution.storage.missing_contact import MissingContact
from robotraj.solution.storage.packing import Packer
from robotraj.solution.storage.plain_data import Damaged, Json, NotPlainData
from robotraj.solution.storage.unpacking import Unpacker

T = TypeVar("T")


class OtherProblem(InputError):
    """A file whose motions belong to another problem."""


NAME = 200
"""Largest number of characters of a name in a warning."""

GROUPS = ("states", "algebraic", "controls")


def pack_problem(problem: Problem, packer: Packer) -> dict[str, Json]:
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
    links = _pack_each(problem.links, packer, "problem.links", ("link", ""), left_out)
    return {
        "robots": [data for data, _ in packed],
        "phases": phases,
        "links": links,
        "left_out": [*left_out, *(name for _, missing in packed for name in missing)],
    }


def unpack_problem(data: Mapping[str, Json], unpacker: Unpacker) -> tuple[Problem, list[str]]:
    """Make the problem again, as far as it was written; also return the names of its missing parts."""
    left_out = [str(name)[:NAME] for name in _part(data, "left_out", list, "problem")]
    robots = [_robot(robot, i, unpacker) for i, robot in enumerate(_part(data, "robots", list, "problem"))]
    stored = _part(data, "phases", list, "problem")
    phases = [_unpack_phase(phase, i, robots, unpacker, left_out) for i, phase in enumerate(stored)]
    links = _unpack_each(_part(data, "links", list, "problem"), unpacker, left_out, "links")
    return Problem(phases, links, missing=tuple(left_out)), left_out


def _part(data: object, name: str, kind: type[T], place: str) -> T:
    """Return an entry of a mapping of the file.

    Raises
    ------
    Damaged
        It is missing, or of another kind.
    """
    found = data.get(name) if isinstance(data, dict) else None
    if not isinstance(found, kind):
        raise Damaged(f"{place} has no {name}")
    return found


def _robot(data: object, number: int, unpacker: Unpacker) -> Robot:
    robot = unpacker.unpack(data, f"robots.{number}")
    if not isinstance(robot, Robot):
        raise Damaged(f"robots.{number} is no robot")
    return with_shapes(robot)


def check_fit(problem: Problem, data: Mapping[str, Json], name: str) -> None:
    """Raise OtherProblem unless the file's trajectories belong to a problem of these phases and variables."""
    phases = _part(data, "phases", list, "problem")
    if len(problem.phases) != len(phases):
        raise OtherProblem(f"{name} has {len(phases)} phases, but problem= has {len(problem.phases)}.")
    for i, (phase, stored) in enumerate(zip(problem.phases, phases, strict=True)):
        variables, place = _part(stored, "variables", dict, f"problem.phases.{i}"), f"problem.phases.{i}.variables"
        for group in GROUPS:
            names = [variable.name for variable in getattr(phase.body, group)]
            known = [_part(variable, "name", str, place) for variable in _part(variables, group, list, place)]
            if names != known:
                label = _part(stored, "fields", dict, place).get("name")
                raise OtherProblem(
                    f"{name} is of another problem: its phase {label!r} has the {group} "
                    f"{known}, phase {phase.name!r} of problem= has {names}."
                )


def _pack_contacts(phase: Phase, packer: Packer, path: str, left_out: list[str]) -> Json:
    """Write contacts; one of another class, or on a Python function, as its variables."""
    held: list[Contact] = []
    for contact in phase.contacts:
        if _is_plain(contact):
            held.append(contact)
        else:
            assert phase.robot is not None
            ground = contact.ground if isinstance(contact.ground, Ground) and _is_plain(contact.ground) else None
            held.append(MissingContact.of(contact, phase.robot, ground))
            left_out.append(f"the equations of contact {_printed(contact)} of phase {phase.name!r}")
    return packer.pack(tuple(held), path)


def _is_plain(value: object) -> bool:
    """Whether a file holds a value."""
    try:
        Packer().pack(value, "")
    except NotPlainData:
        return False
    return True


def _pack_phase(phase: Phase, robot: int | None, packer: Packer, path: str, left_out: list[str]) -> dict[str, Json]:
    whose = f"of phase {phase.name!r}"
    system = phase.system
    if system is not None:
        left_out.append(f"the equations of system {system.name!r}")
    plain = {}
    for entry in fields(phase):
        if entry.name not in ("subject", "constraints", "objective", "contacts"):
            plain[entry.name] = packer.pack(getattr(phase, entry.name), f"{path}.{entry.name}")
    plain["contacts"] = _pack_contacts(phase, packer, f"{path}.contacts", left_out)
    terms = phase.objective.terms if phase.objective is not None else ()
    return {
        "robot": robot,
        "system": None if system is None else system.name,
        "variables": {
            group: [{"name": v.name, "unit": v.unit} for v in getattr(phase.body, group)] for group in GROUPS
        },
        "fields": plain,
        "constraints": _pack_each(
            [constraint.as_data(phase.robot) for constraint in phase.constraints],
            packer,
            f"{path}.constraints",
            ("constraint", whose),
            left_out,
        ),
        "objective": _pack_each(terms, packer, f"{path}.objective", ("objective", whose), left_out),
    }


def _unpack_phase(
    data: Mapping[str, Json], number: int, robots: Sequence[Robot], unpacker: Unpacker, left_out: list[str]
) -> Phase:
    place = f"problem.phases.{number}"
    stored = _part(data, "fields", dict, place)
    plain = {name: unpacker.unpack(entry, f"{place}.{name}") for name, entry in stored.items()}
    robot = data.get("robot")
    if robot is None:
        subject: Robot | System = _system(
            _part(data, "system", str, place), _part(data, "variables", dict, place), place
        )
    elif type(robot) is int and 0 <= robot < len(robots):
        subject = robots[robot]
    else:
        raise Damaged(f"{place} moves robot {robot!r}, which is not in the file")
    terms = _unpack_each(_part(data, "objective", list, place), unpacker, left_out, f"{place}.objective")
    objective: Objective | None = Sum(tuple(terms)) if terms else None
    if len(terms) == 1 and terms[0][0] == 1.0:
        objective = terms[0][1]
    constraints = _unpack_each(_part(data, "constraints", list, place), unpacker, left_out, f"{place}.constraints")
    given = plain | {"subject": subject, "constraints": tuple(constraints), "objective": objective}
    wrong = mismatch(Phase, given)
    if wrong is not None:
        raise Damaged(f"{place}: {wrong}")
    with unread_shapes():
        return Phase(**given)


def _system(name: str, variables: Mapping[str, Json], place: str) -> System:
    """Make a System of the right variables, whose equations raise an error that names them as missing."""
    groups = {}
    for group in GROUPS:
        entries = _part(variables, group, list, f"{place}.variables")
        where = f"{place}.variables.{group}"
        groups[group] = [Variable(_part(v, "name", str, where), _part(v, "unit", str, where)) for v in entries]
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
    values: Sequence[object], packer: Packer, path: str, described: tuple[str, str], left_out: list[str]
) -> list[dict[str, Json]]:
    """Write what can be written, each with its name for people; name the others in ``left_out``."""
    written, (kind, whose) = [], described
    for i, value in enumerate(values):
        name = f"{kind} {_printed(value)} {whose}".rstrip()
        try:
            written.append({"name": name, "value": packer.pack(value, f"{path}.{i}")})
        except NotPlainData:
            left_out.append(name)
    return written


def _unpack_each(data: Sequence[Mapping[str, Json]], unpacker: Unpacker, left_out: list[str], place: str) -> list[Json]:
    values = []
    for i, entry in enumerate(data):
        name = _part(entry, "name", str, f"{place}.{i}")[:NAME]
        try:
            values.append(unpacker.unpack(entry.get("value"), f"{place}.{i}"))
        except NotPlainData as error:
            left_out.append(f"{name} ({error})")
    return values


def _printed(value: object) -> str:
    """Print a constraint, link or weighted term."""
    if isinstance(value, tuple):
        weight, term = value
        return _printed(term) if weight == 1 else f"{weight:g} {_printed(term)}"
    return repr(value)


def pack_robot(robot: Robot, packer: Packer, path: str) -> tuple[Json, list[str]]:
    """Write a robot; also return the names of shapes that are not plain data, which are not written."""
    try:
        return packer.pack(robot, path), []
    except NotPlainData:
        bare = replace(robot, geometry=NoGeometry())
        return packer.pack(bare, path), [f"the shapes of robot {robot.name!r}, which came with its model"]


def with_shapes(robot: Robot) -> Robot:
    """Find a robot's shapes again: in the URDF they were read from, else in the catalogue's of its name.

    A file widens no path: folders that it names are not searched, and meshes outside the folders of a URDF are trusted
    where it belongs to the catalogue, whatever the file claims. This holds for the parts of a joined robot too.
    """
    return replace(robot, geometry=_found_again(robot.geometry, robot.name))


def _found_again(geometry: Geometry, name: str) -> Geometry:
    if isinstance(geometry, JoinedGeometry):
        parts = tuple(
            replace(part, geometry=_found_again(part.geometry, str(part.model.name))) for part in geometry.parts
        )
        return replace(geometry, parts=parts)
    if not isinstance(geometry, UrdfGeometry):
        return geometry
    known = geometry.urdf in {entry.urdf for entry in catalogue()}
    if known or os.path.isfile(geometry.urdf):
        return UrdfGeometry(geometry.urdf, (), trust_paths=known)
    try:
        return UrdfGeometry(find(name).urdf, (), trust_paths=True)
    except UnknownName:
        warn(f"The URDF of {name!r} is gone ({geometry.urdf}): its shapes are missing, nothing else.")
        return NoGeometry()
