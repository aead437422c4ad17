"""What problem files may state, written out from the classes and functions themselves."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from robotraj._util.errors import unknown_name
from robotraj._util.printing import brief
from robotraj._util.values import dataclass
from robotraj.applications.problem_files.kinds import GAITS, KINDS
from robotraj.applications.problem_files.load import FROM_CALLS, OF_CALLERS, OUTPUTS
from robotraj.applications.problem_files.parameters import Maker, Parameter, accepted_by, described, parameters_of
from robotraj.applications.problem_files.robots import MAKERS
from robotraj.planning.plan import plan
from robotraj.problem.constraints.joint_limits import OwnLimits
from robotraj.problem.phase import Phase
from robotraj.replay_page.write import replay
from robotraj.robot import carried_body
from robotraj.robot.limits import Limits
from robotraj.witness.validation import validate

GROUPS: Sequence[tuple[str, str]] = (
    ("Objectives", "problem.objectives"),
    ("Constraints", "problem.constraints"),
    ("Links of phases", "problem.links"),
    ("States", "problem.state"),
    ("Contacts", "dynamics.contacts"),
    ("Ground", "dynamics.terrain"),
    ("Obstacles", "dynamics.obstacles"),
    ("Design", "dynamics.design"),
    ("Dynamics", "dynamics"),
    ("Carried bodies", "robot"),
    ("Expressions and values of gaits", "gait"),
    ("Guesses", "guess"),
    ("Meshes and schemes", "transcription.schemes"),
    ("Solvers", "solvers"),
    ("Refinement", "transcription.refinement"),
    ("Limits between the points", "transcription.interval_limits"),
    ("Engines", "native.engines"),
    ("Goals and restarts", "solution"),
)
"""Headings, and the folders of the classes under them; the first one that matches is taken."""


@dataclass(frozen=True)
class SchemaEntry:
    """A table of the file, or a class that ``type`` names.

    Attributes
    ----------
    name : str
    summary : str
        First sentence of its docstring.
    parameters : tuple of Parameter
    """

    name: str
    summary: str
    parameters: tuple[Parameter, ...]

    def rows(self) -> list[tuple[str, str, str]]:
        """Key, accepted values and default of every parameter."""
        return [
            (each.name, described(each.accepted), "required" if each.required else _default(each.default))
            for each in self.parameters
        ]


def entries() -> Mapping[str, list[SchemaEntry]]:
    """Return every table and class by heading, in the order of the documentation."""
    found: dict[str, list[SchemaEntry]] = {"Tables": _tables()}
    found["Gaits"] = [_entry(name, maker, ("robot",)) for name, maker in sorted(GAITS.items())]
    for name, kind in KINDS.items():
        folder = kind.__module__.removeprefix("robotraj.") + "."
        heading = next(title for title, start in GROUPS if folder.startswith(start + "."))
        found.setdefault(heading, []).append(_entry(name, kind, ("robot",)))
    order = ["Tables", "Gaits", *(title for title, _ in GROUPS)]
    return {title: found[title] for title in order if title in found}


def entry_named(name: str) -> SchemaEntry:
    """Return a table, gait or class.

    Raises
    ------
    UnknownName
        There is none.
    """
    known = {entry.name.strip("[]"): entry for group in entries().values() for entry in group}
    if name.strip("[]") not in known:
        raise unknown_name("table or type of problem files", name, known)
    return known[name.strip("[]")]


def reference() -> str:
    """Return the schema as Markdown, for the site."""
    lines: list[str] = []
    for title, group in entries().items():
        lines += [f"### {title}", ""]
        for entry in group:
            lines += [f"**`{entry.name}`**: {_plain(entry.summary)}", ""]
            rows = [(f"`{key}`", accepted, default) for key, accepted, default in entry.rows()]
            if rows:
                lines += ["| key | takes | default |", "|---|---|---|"]
                lines += [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows] + [""]
    return "\n".join(lines)


def _tables() -> list[SchemaEntry]:
    """Return the tables of a file."""
    files = tuple(Parameter(name, "str", None, _PATH) for name in OUTPUTS)
    tables: list[tuple[str, Maker, Sequence[str]]] = [
        ("[robot]", MAKERS["load"], ()),
        ('[robots.NAME] type = "join"', MAKERS["join"], ()),
        ('[robots.NAME] type = "on_wheels"', MAKERS["on_wheels"], ()),
        ('[robots.NAME] type = "on_rail"', MAKERS["on_rail"], ()),
        ("[[phases]]", Phase, ("subject",)),
        ("[phases.limits]", Limits.with_, ()),
        ("[plan]", plan, OF_CALLERS),
        ("[validate]", validate, ("solution",)),
        ("[replay]", replay, FROM_CALLS),
    ]
    found = [_entry(name, maker, without) for name, maker, without in tables]
    found = [replace(entry, parameters=(*entry.parameters, *_ADDED.get(entry.name, ()))) for entry in found]
    return [*found, SchemaEntry("[output]", "Files that are written, beside the problem file.", files)]


_PATH = parameters_of(replay)["path"].accepted
_BODIES = accepted_by("CarriedBody | Sequence[CarriedBody] | None", carried_body.__name__)
_ADDED: Mapping[str, Sequence[Parameter]] = {
    "[robot]": [Parameter("payload", "", None, _BODIES)],
    "[[phases]]": [Parameter("robot", "", None, accepted_by("Robot", Phase.__module__))],
}
"""Keys that are no parameters of the class or function: bodies that a robot carries, the robot of a phase."""


def _entry(name: str, maker: Maker, without: Sequence[str]) -> SchemaEntry:
    kept = tuple(each for each in parameters_of(maker).values() if each.name not in without)
    return SchemaEntry(name, _summary(maker), kept)


def _summary(maker: Maker) -> str:
    """First paragraph of a docstring."""
    return " ".join((inspect.getdoc(maker) or "").partition("\n\n")[0].split())


def _plain(text: str) -> str:
    """Write roles and double backticks of docstrings in Markdown."""
    return re.sub(r"``([^`]*)``", r"`\1`", text)


def _default(value: object) -> str:
    if isinstance(value, OwnLimits):
        return "the robot's"
    if value is None or isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple | list):
        return f"[{', '.join(_default(each) for each in value)}]"
    return brief(value)
