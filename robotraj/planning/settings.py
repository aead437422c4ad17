"""Decisions on the settings that the user leaves open, by one table of rules.

The first rule of a setting whose conditions hold applies; a setting is None where none does. Settings are decided in
the order of ``SETTINGS``: a condition may read given settings and those decided before.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.precision import MET
from robotraj._util.printing import as_call
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine
from robotraj.native.engines.native import Native
from robotraj.planning import setting_conditions as when
from robotraj.planning.proving.first_mesh import (
    FEW,
    SECOND,
    STICKING,
    SYSTEM,
    UNREFINED,
    MeshesOfLines,
    MeshesOnPaths,
    MeshOfShares,
    OfProblem,
    ProportionalMeshes,
    RefinementOfShares,
    RefinementOfStates,
    graded,
)
from robotraj.planning.setting_conditions import Case, Condition
from robotraj.problem.problem import Problem
from robotraj.solution.proof import Goals
from robotraj.solution.settings import Restarts as Restarts
from robotraj.solution.settings import Settings as Settings
from robotraj.solvers.base import ALTERED_BARRIER, Solver
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.ipopt import Ipopt
from robotraj.transcription.interval_limits.methods import BernsteinBounds, ConstraintGeneration
from robotraj.transcription.refinement.base import Refinement
from robotraj.transcription.refinement.equidistribution import Equidistribute
from robotraj.transcription.refinement.raise_order import SplitOrRaise
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.radau import RadauIIA
from robotraj.transcription.smoothness.smoothing import SMOOTHING

GIVEN = "given"
"""Reason of a setting that the user gave."""


@dataclass(frozen=True, eq=False)
class Rule:
    """A choice of one setting.

    Attributes
    ----------
    setting : str
        Name of the setting and of the option of ``rt.plan``.
    conditions : tuple of Condition
        Conditions that must all hold.
    choice : object
        Value of the setting, or a rule for it such as ``ProportionalMeshes``.
    reason : str
        Clause at the end of a line of printed settings.
    """

    setting: str
    conditions: tuple[Condition, ...]
    choice: object
    reason: str

    def holds(self, case: Case) -> bool:
        """Whether all conditions hold."""
        return all(condition.holds(case) for condition in self.conditions)


def _rule(setting: str, *conditions_choice_reason: object) -> Rule:
    *conditions, choice, reason = conditions_choice_reason
    return Rule(setting, tuple(c for c in conditions if isinstance(c, Condition)), choice, str(reason))


RULES: tuple[Rule, ...] = (
    _rule("goals", when.OPEN_MESH, Goals(), "a plan is proved between its points where no mesh is given"),
    _rule("mesh", when.ON_PATH, MeshesOnPaths(), "lines between knots keep limits between the points"),
    _rule(
        "mesh", when.PROVED, when.ARMS, when.STICKING, when.FREE_RATES, graded(FEW, STICKING), "joints stop anywhere"
    ),
    _rule(
        "mesh",
        when.PROVED,
        when.EXACT,
        when.KINKED,
        MeshesOfLines(),
        "accelerations that bend between the points hide power from the quadrature",
    ),
    _rule("mesh", when.PROVED, when.EXACT, MeshOfShares(), "least times converge more slowly than integrals"),
    _rule("mesh", when.PROVED, when.CONTACTS, ProportionalMeshes(), "a coarse mesh approximates a step"),
    _rule("mesh", when.PROVED, Mesh(SYSTEM), "a coarse mesh approximates the motion"),
    _rule("mesh", when.FREE_RATES, Mesh(UNREFINED, RadauIIA(3)), "refinement starts from a coarse mesh"),
    _rule("mesh", when.ALWAYS, Mesh(UNREFINED), "a variable whose rate is limited is continuous at the knots"),
    _rule("solver", when.FOR_IPOPT, Ipopt(), "other solvers call no such engine, and have no stages of such meshes"),
    _rule(
        "solver",
        when.PROVED,
        when.EXACT,
        when.KINKED,
        InteriorPoint(tolerance=MET, initial_barrier=ALTERED_BARRIER),
        "it is several times faster than IPOPT",
    ),
    _rule("solver", when.KINKED, Ipopt(), "it finds the local optimum next to the guess"),
    _rule("solver", when.PROVED, InteriorPoint(tolerance=MET), "a hundredth of the allowed errors"),
    _rule("solver", when.ALWAYS, InteriorPoint(), "it finds the optima of IPOPT in less time"),
    _rule("engine", when.ALWAYS, Native(), "it needs no compiler at run time, and is the fastest for large graphs"),
    _rule(
        "interval_limits",
        when.PROVED,
        BernsteinBounds(controls=True, positions=True),
        "limits of positions, speeds and torques hold everywhere in one solve",
    ),
    _rule(
        "interval_limits",
        when.TOLERANCE,
        when.ROBOTS,
        when.STAGEWISE,
        when.FREE_TIME,
        BernsteinBounds(controls=True),
        "one solve a mesh; their effect on the objective falls with the mesh",
    ),
    _rule(
        "interval_limits",
        when.TOLERANCE,
        when.STAGES_OR_SYSTEM,
        BernsteinBounds(states=False, controls=True),
        "bounds on coefficients of speeds would raise the objective by more than the tolerance at a fixed duration",
    ),
    _rule(
        "interval_limits",
        when.ROBOTS,
        when.STAGEWISE,
        BernsteinBounds(),
        "limits of speed hold everywhere in one solve; further rows are cheap for a solver by stages",
    ),
    _rule(
        "interval_limits",
        when.ALWAYS,
        ConstraintGeneration(),
        "rows are imposed only where a solution violates them, so the optimum stays",
    ),
    _rule(
        "refinement",
        when.PROVED,
        when.ARMS,
        when.STICKING,
        Equidistribute(second=SECOND, slope=0.3),
        "many knots are needed near the times at which joints stick and slide, which differ from mesh to mesh",
    ),
    _rule("refinement", when.PROVED, when.EXACT, RefinementOfShares(), "the second mesh mostly settles the objective"),
    _rule("refinement", when.PROVED, RefinementOfStates(), "the order of the scheme predicts the mesh"),
    _rule("refinement", when.TOLERANCE, SplitOrRaise(), "smooth intervals get more points, others are split"),
    _rule("restarts", when.CONTACTS, Restarts(0), "other initial guesses seldom help with contacts, and take long"),
    _rule("restarts", when.PASSIVE, Restarts(12, seeds=range(9)), "their motions have many local optima"),
    _rule("restarts", when.ALWAYS, Restarts(), "a guess may be too short, or cross an obstacle"),
    _rule("smoothing", when.PROVED, SMOOTHING, "of motions as short or hardly more costly the smoothest is chosen"),
    _rule("smoothing", when.ALWAYS, 0.0, "a mesh or a tolerance is given"),
)

SETTINGS = tuple(each.name for each in fields(Settings) if each.name != "reasons")
"""Names of all settings, in the order in which they are decided."""

_NONE = Rule("", (), None, "not given")
_RULES_OF = {name: tuple(rule for rule in RULES if rule.setting == name) for name in SETTINGS}


def resolve(problem: Problem, given: Mapping[str, object], settings: Settings | None = None) -> Settings:
    """Decide every setting that is neither given nor part of earlier settings.

    Parameters
    ----------
    problem : Problem
    given : mapping of str to object
        Options by name; None leaves an option open. They replace those of ``settings``.
    settings : Settings, optional
        Settings of an earlier plan, which leave nothing open.

    Returns
    -------
    Settings

    Raises
    ------
    InputError
        An option has another type, or ``refinement`` is given with a mesh alone.
    """
    if settings is not None and not isinstance(settings, Settings):
        raise InputError(f"settings= must be the settings of a solution, solution.settings; got {settings!r}.")
    values: dict[str, Any] = {}
    reasons: dict[str, str] = {}
    proved = settings is not None and settings.goals is not None
    reopened = ("goals", "refinement") if proved and _replaces_goals(given) else ()
    for name in SETTINGS:
        if given.get(name) is not None:
            values[name], reasons[name] = _checked(name, given[name]), GIVEN
        elif settings is not None and name not in reopened:
            values[name], reasons[name] = getattr(settings, name), settings.reasons.get(name, GIVEN)
    for name in SETTINGS:
        if name not in values:
            case = Case(problem, values)
            rule = next((rule for rule in _RULES_OF[name] if rule.holds(case)), _NONE)
            choice = rule.choice.of(problem) if isinstance(rule.choice, OfProblem) else rule.choice
            values[name], reasons[name] = choice, rule.reason
    if values["refinement"] is not None and values["tolerance"] is None and values["goals"] is None:
        raise InputError(
            "refinement= chooses how meshes are refined, but a mesh given alone is not refined; "
            "give tolerance= or goals= as well."
        )
    return Settings(**values, reasons={name: reasons[name] for name in SETTINGS})


def table() -> str:
    """Return the rules as the table in the docstring of ``rt.plan``: setting, condition, choice."""
    rows = [("setting", "where", "choice")]
    rows += [(r.setting, ", ".join(c.text for c in r.conditions), as_call(r.choice)) for r in RULES]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    names = ["", *(row[0] for row in rows[1:])]
    cells = [("" if row[0] == before else row[0], *row[1:]) for before, row in zip(names, rows[1:], strict=False)]
    rule = "  ".join("=" * width for width in widths)
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in [rows[0], *cells]]
    return "\n".join(line.rstrip() for line in [rule, lines[0], rule, *lines[1:], rule])


def _replaces_goals(given: Mapping[str, object]) -> bool:
    """Whether a mesh or a tolerance is given, which replaces the goals of earlier settings."""
    return given.get("mesh") is not None or given.get("tolerance") is not None


def _is_tolerance(value: object) -> bool:
    return isinstance(value, float | int | np.number) and bool(0 < value < 1)


def _is_share(value: object) -> bool:
    return isinstance(value, float | int | np.number) and bool(0 <= value <= 1)


def _is_mesh(value: object) -> bool:
    return isinstance(value, Mesh) or (isinstance(value, Sequence) and all(isinstance(mesh, Mesh) for mesh in value))


def _is_a(kind: type) -> Callable[[object], bool]:
    return lambda value: isinstance(value, kind)


_CHECKS: Mapping[str, tuple[Callable[[object], bool], str]] = {
    "tolerance": (_is_tolerance, "is a relative error between 0 and 1, such as 1e-6"),
    "goals": (_is_a(Goals), "must be an rt.solution.Goals"),
    "mesh": (_is_mesh, "must be an rt.Mesh, such as rt.Mesh(40), or one for each phase"),
    "solver": (_is_a(Solver), "must be a solver value such as rt.Ipopt()"),
    "engine": (_is_a(Engine), "must be rt.engines.VirtualMachine(), rt.engines.Native() or rt.engines.Compiled()"),
    "interval_limits": (
        _is_a(ConstraintGeneration),
        "must be rt.interval_limits.ConstraintGeneration() or rt.interval_limits.BernsteinBounds()",
    ),
    "refinement": (_is_a(Refinement), "must be one such as rt.refinement.SplitOrRaise()"),
    "smoothing": (_is_share, "is a share from 0 to 1, such as 1e-3"),
    "restarts": (_is_a(Restarts), "must be rt.planning.Restarts(), or rt.planning.Restarts(0) for none"),
}
"""For each setting, a test of the given value and a description of valid ones."""


def _checked(name: str, value: object) -> object:
    """Return a setting that the user gave; lists of meshes become tuples."""
    fits, wanted = _CHECKS[name]
    if not fits(value):
        raise InputError(f"{name}= {wanted}; got {value!r}.")
    return tuple(value) if name == "mesh" and isinstance(value, Sequence) else value
