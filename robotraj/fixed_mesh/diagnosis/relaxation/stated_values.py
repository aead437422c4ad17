"""Stated values that suffice: the problem is solved with each of them, and a larger one is stated where that fails.

Values come from a relaxed problem on a coarse mesh. Its motion may exceed limits between its points, by several times
what a short motion within a long duration needs, and from the guess of a plan a solver need not find a motion that
barely exists. Only values that were tried count as remedies, also where a theorem excludes the given ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.time_left import LimitReached
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.row import Row
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.problem.constraints.base import BoundConstraint, Constraint
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict

LONGER = (1.0, 1.15, 1.4)
"""Multiples of a stated duration that are tried."""
WIDER = (1.0, 1.25, 2.0, 4.0, 8.0)
"""Multiples of what a stated bound gives way that are tried."""
CLOSE = 1.1
"""Ratio of a multiple that suffices and one that does not, below which no other one is tried between them."""
SHORT_OF_ENOUGH = "or more: no motion was found with it"
"""Reason of a value with which no multiple suffices."""


def sufficient(
    conflicts: Sequence[Conflict], problem: Problem, coarse: CoarseSolves, excluded: bool = False
) -> tuple[Conflict, ...]:
    """Return conflicts with values that suffice, of all rows together and of the duration alone.

    Durations that do not suffice are left out. One that suffices alone stands before rows that do not or were not
    tried, such as limits of rates. Conflicts that are certain, and those of motions with contacts, are returned as they
    are.

    Parameters
    ----------
    conflicts : sequence of Conflict
    problem : Problem
    coarse : CoarseSolves
    excluded : bool
        Whether a theorem excludes every motion within the given bounds. Values that suffice are certain then.
    """
    rows = [each for each in conflicts if each.name != "duration"]
    if any(each.certain or each.reason for each in rows) or any(phase.contacts for phase in problem.phases):
        return tuple(conflicts)
    durations = [each for each in conflicts if each.name == "duration"]
    of_rates = {row.label for phase in problem.phases for row in phase.rows.rates}
    untried = any(each.name in of_rates for each in rows)
    try:
        enough = rows if untried else _first(rows, problem, coarse, WIDER)
        longer = _first(durations, problem, coarse, LONGER)
    except LimitReached:
        return tuple(conflicts)
    if excluded:
        enough, longer = ([replace(each, certain=True) for each in some] for some in (enough, longer))
    if len(enough) == 1 and not untried:
        return (*enough, *longer)
    # Several rows suffice together or were not tried, and a duration suffices without any of them.
    return (*longer, *(enough or [replace(each, reason=SHORT_OF_ENOUGH) for each in rows]))


def _first(
    conflicts: Sequence[Conflict], problem: Problem, coarse: CoarseSolves, multiples: Sequence[float]
) -> list[Conflict]:
    """Return the conflicts with about the least multiple that suffices; empty without one."""

    def with_multiple(multiple: float) -> list[Conflict]:
        wider = [_further(each, multiple) for each in conflicts]
        return wider if coarse.has_motion(_with_values(problem, wider)) else []

    short = 1.0
    for multiple in multiples if conflicts else ():
        try:
            found = with_multiple(multiple)
            while found and multiple > CLOSE * short:
                between = float(np.sqrt(short * multiple))
                nearer = with_multiple(between)
                found, multiple, short = (nearer, between, short) if nearer else (found, multiple, between)
        except InputError:
            return []
        if found:
            return found
        short = multiple
    return []


def _further(conflict: Conflict, multiple: float) -> Conflict:
    """Return a conflict with a value further from the bound."""
    if conflict.name == "duration":
        return replace(conflict, needed=multiple * conflict.needed)
    return replace(conflict, needed=conflict.bound + multiple * (conflict.needed - conflict.bound))


def _with_values(problem: Problem, conflicts: Sequence[Conflict]) -> Problem:
    """Return the problem with the stated values in place of the bounds."""
    phases = []
    for phase in problem.phases:
        own = [each for each in conflicts if each.phase == phase.name]
        longer = [each.needed for each in own if each.name == "duration"]
        if longer:
            least, longest = phase.duration_bounds
            phase = phase.with_(duration=longer[0] if least == longest else (least, longer[0]))
        rows = [each for each in own if each.name != "duration"]
        phases.append(_with_bounds(phase, rows) if rows else phase)
    return Problem(phases, problem.links)


def _with_bounds(phase: Phase, conflicts: Sequence[Conflict]) -> Phase:
    """Return a phase whose limits and constraints have other bounds where they are in conflict."""
    names = {each.name for each in conflicts}
    of_rows = [bound for bound in phase.rows.constraints if bound.source is not None]
    concerned = [bound.source for bound in of_rows if names & {row.label for row in bound.rows}]
    own = [bound.source for bound in of_rows if not any(bound.source is each for each in phase.constraints)]

    def widened(constraint: Constraint) -> Constraint:
        is_concerned = any(constraint is each for each in concerned)
        return _Stated(constraint, tuple(conflicts)) if is_concerned else constraint

    constraints = [widened(each) for each in phase.constraints]
    if not any(each is limit for each in concerned for limit in own):
        return phase.with_(constraints=constraints)
    limits = [widened(each) for each in own if each is not None]
    return phase.with_(limits=None, states={}, controls={}, algebraic={}, constraints=[*limits, *constraints])


@dataclass(frozen=True)
class _Stated(Constraint):
    """A constraint whose rows in conflict have the stated values as bounds."""

    inner: Constraint
    conflicts: tuple[Conflict, ...]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Replace the bounds of rows in conflict."""
        bound = self.inner.bind(dynamics, parameters)
        return replace(bound, rows=tuple(self._stated(row) for row in bound.rows))

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables that the constraint reads."""
        return self.inner.augment(dynamics)

    def _stated(self, row: Row) -> Row:
        for conflict in self.conflicts:
            if conflict.name != row.label:
                continue
            low, high = (row.measure.of(each) if row.measure else each for each in (row.lower, row.upper))
            # A bound and its opposite are one limit, as that of a torque.
            both, size = low == -high, conflict.needed if row.measure is None else row.measure.value_of(conflict.needed)
            if both:
                row = replace(row, lower=-abs(size), upper=abs(size))
            elif np.isclose(conflict.bound, low, rtol=1e-9, atol=0.0):
                row = replace(row, lower=size)
            elif np.isclose(conflict.bound, high, rtol=1e-9, atol=0.0):
                row = replace(row, upper=size)
        return row
