"""The proof on the page: the verdict, its figures, the violated rows, the meshes and the convergence."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Literal, Protocol

import numpy as np

from robotraj._util.printing import OneLine
from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation

Colour = Literal["good", "unproved", "bad"]
"""Green for a proved or validated plan, amber for a motion that was not proved, red for no motion."""

Data = dict[str, object]
"""Values that JSON can hold."""

LISTED = 40
"""Largest number of violated rows on the page."""

TERMINAL_COLOUR = re.compile(r"\x1b\[\d*m")

UNPROVED = ("NOT_PROVED", "TOLERANCE_NOT_REACHED")
"""Names of statuses of a plan that satisfies the rows of its mesh, but not the goals between mesh points."""


class Validation(Protocol):
    """What the page needs of a ``witness.Report``, whose text is ``str(report)``."""

    @property
    def passed(self) -> bool:
        """Whether no claim fails."""
        ...

    @property
    def claims(self) -> Sequence[Claim]:
        """The claims with their judgements."""
        ...

    @property
    def duration(self) -> float:
        """Duration of the validated plan [s]."""
        ...


@dataclass(frozen=True)
class Verdict(OneLine):
    """The verdict that the page shows on a plan.

    Attributes
    ----------
    colour : Colour
    text : str
        ``"proved"``, ``"validated by simulation"``, ``"solved; nothing was proved"``, ``"infeasible"`` ...
    """

    colour: Colour
    text: str


@dataclass(frozen=True)
class Figure(OneLine):
    """One measure beside its goal.

    Attributes
    ----------
    name : str
    value : float or None
        None where it is infinite or not a number.
    goal : float or None
        The largest value that is accepted; None where there is no goal.
    colour : Colour
    """

    name: str
    value: float | None
    goal: float | None
    colour: Colour


def verdict(solution: Solution, report: Validation | None = None) -> Verdict:
    """Return the verdict; it is green only if every claim that applies was judged and holds.

    Amber names what was not judged.
    """
    planned = _planned(solution)
    if planned.colour == "bad":
        return planned
    if report is None:
        return Verdict("unproved", f"{planned.text}, not validated") if planned.colour == "good" else planned
    if not report.passed:
        return Verdict("bad", "validation failed")
    missing = [claim.name for claim in report.claims if claim.judgement is Judgement.NOT_JUDGED]
    if planned.colour == "good" and not missing:
        return Verdict("good", "proved and validated")
    text = "validated by simulation" if solution.proof is None else f"{planned.text}; validated"
    return Verdict("unproved", f"{text}; not judged: {', '.join(missing)}" if missing else text)


def _planned(solution: Solution) -> Verdict:
    """Return the verdict of the planner alone."""
    if solution.status.name in UNPROVED:
        return Verdict("unproved", solution.status.value)
    if not solution.success:
        return Verdict("bad", solution.status.value)
    if solution.proof is None:
        return Verdict("unproved", "solved; nothing was proved")
    if solution.proof.holds:
        return Verdict("good", "proved")
    known = solution.proof.motion_holds
    return Verdict("unproved", solution.proof.verdict if known else "solved, not proved")


COLOURS: dict[Judgement, Colour] = {
    Judgement.HOLDS: "good",
    Judgement.NOT_JUDGED: "unproved",
    Judgement.FAILS: "bad",
}


def figures(solution: Solution, report: Validation | None = None) -> list[Figure]:
    """List the claims with their figures, those of the validation where there is one, and figures of the rows."""
    proof = solution.proof
    claims = solution.claims if report is None else report.claims
    found = [
        Figure(
            f"{claim.name}: {claim.judgement.value}",
            None if claim.figure is None else _number(claim.figure),
            claim.bound,
            COLOURS[claim.judgement],
        )
        for claim in claims
    ]
    if proof is None and solution.success and np.isfinite(solution.error):
        # The rates of a failed plan may be accurate although its rows are violated.
        found.append(Figure("error between knots", _number(solution.error), None, "unproved"))
    rows, exceeded = len(solution.violation_list), _limits_exceeded(solution)
    found.append(Figure("violated rows", rows, None, "bad" if rows else "good" if proof is not None else "unproved"))
    if proof is None:
        found.append(Figure("limits exceeded between points", len(exceeded), None, "unproved"))
    return found


def proof_data(solution: Solution, report: Validation | None = None) -> Data:
    """Return the page's data on the proof.

    Returns
    -------
    dict
        ``figures``, ``violations`` (text, time, phase, variable), ``meshes``, ``stages``, ``times`` [s], ``problem``,
        ``settings``, ``message``, ``conflicts`` and ``report``, the text of the validation.
    """
    return {
        "figures": [asdict(figure) for figure in figures(solution, report)],
        "violations": [_violation(solution, v) for v in _worst_of_each_row(solution)[:LISTED]],
        "meshes": [{name: _number(value) for name, value in asdict(step).items()} for step in solution.refinement]
        or _given_mesh(solution),
        "goal": None if solution.proof is None else solution.proof.goals.error,
        "stages": [
            f"{stage.name}: {stage.status.value}, {stage.iterations} iterations" for stage in solution.continuation
        ],
        "times": {name: round(seconds, 4) for name, seconds in solution.times.items()},
        "message": solution.message,
        "conflicts": [solution.in_phase(conflict) for conflict in solution.conflicts],
        "problem": str(solution.problem),
        "settings": "" if solution.settings is None else str(solution.settings),
        "report": "" if report is None else TERMINAL_COLOUR.sub("", str(report)),
    }


def _given_mesh(solution: Solution) -> list[Data]:
    """Describe the only mesh of a plan that was not refined; its error is unknown."""
    return [
        {
            "intervals": sum(len(part.knots) - 1 for part in solution.phases),
            "points": sum(len(part.points) for part in solution.phases),
            "error": None,
            "objective": _number(solution.objective),
            "iterations": solution.iterations,
            "seconds": round(solution.seconds, 4),
        }
    ]


def _worst_of_each_row(solution: Solution) -> list[Violation]:
    """Return the largest violation of each row, largest first."""
    ranked = sorted((*solution.violation_list, *_limits_exceeded(solution)), key=lambda violation: -violation.relative)
    found: dict[tuple[str, str], Violation] = {}
    for violation in ranked:
        found.setdefault((violation.phase, violation.label), violation)
    return list(found.values())


def _limits_exceeded(solution: Solution) -> tuple[Violation, ...]:
    return (*solution.interval_violations, *solution.control_interval_violations)


def _violation(solution: Solution, violation: Violation) -> Data:
    """Describe a violated row and name the variable whose curve carries its mark."""
    named = [part for part in solution.phases if part.phase.name == violation.phase]
    # Phases may share a name: the violation belongs to the one that runs at its time.
    inside = [part for part in named if part.t0 <= violation.time <= part.t0 + part.duration]
    variables = [_variable(part, violation) for part in (inside or named)[:1]]
    return {
        "text": str(violation),
        "t": _number(violation.time),
        "phase": violation.phase,
        "variable": variables[0] if variables else None,
    }


def _variable(part: PhaseSolution, violation: Violation) -> str | None:
    """Return the variable that a violated row bounds, or the state of a violated defect; None for other rows."""
    for row in part.phase.rows.bounds:
        if row.name == violation.name and row.joint == violation.joint:
            return part.phase.rows.variable_of(row).name
    states = [state.name for state in part.phase.dae.states]
    return violation.joint if violation.joint in states else None


def _number(value: float) -> float | None:
    """Round to six digits; return None for a value that is not finite, which JSON cannot hold."""
    return float(f"{value:.6g}") if np.isfinite(value) else None
