"""Limits that conflict with each other: the problem with relaxed rows, at the least total relaxation.

Each inequality l <= c(point) <= u of a phase becomes l - w s <= c <= u + w s, where s >= 0 is the slack of the row and
w its scale in its unit. The sum of the slacks is minimised. The slack of an integral is spread over the phase's
duration. Dynamics, ends of the state, contacts and links stay exact. The least sum leaves most slacks at zero. A
second, reweighted solve reduces their number further. Where limits of speeds, accelerations, torques or controls must
be relaxed, a longer duration may suffice instead. The least one is found with exact rows.
Source: Candes, Wakin and Boyd, Enhancing sparsity by reweighted l1 minimization, J. Fourier Anal. Appl. 14 (2008);
Gill, Murray and Saunders, SNOPT, SIAM Review 47 (2005), for the elastic mode.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import RobotrajError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Where
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.expressions import Mayer
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.problem.problem import Problem
from robotraj.problem.rows import RowTable
from robotraj.solution.conflict import ROOM_OF_DURATION, Conflict, with_room
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

Array = NDArray[np.float64]
Solve = Callable[[Problem, "InitialGuess | Solution | None"], Solution]
"""(problem, guess) -> Solution, on a mesh and with a solver of the caller's choice."""

SMALL = 1e-3
"""Slacks, relative to the row's scale, that count as zero."""
LONGEST = 30.0
"""Longest duration that is tried, relative to the longest allowed one."""
AT_AN_END = 5.0
"""Weight of slacks of rows at one end: limits are relaxed before the goals of the motion."""


KEPT = (Where.RATE,)
"""Kinds of rows that are not relaxed."""


@dataclass(frozen=True)
class _RelaxedRow:
    """One row to relax: its table, its slack (a parameter's name) and, for an integral, its duration [s]."""

    table: RowTable
    row: PhaseRow
    name: str
    duration: float = 1.0

    @property
    def rate(self) -> float:
        """Change of the row's expression by a slack of 1: its scale, for an integral divided by the duration."""
        return self.scale / self.duration

    @property
    def scale(self) -> float:
        """Unit of the slack: the larger finite bound, else 1, in the row's unit."""
        return self.row.greatest_bound or 1.0

    @property
    def weight(self) -> float:
        """Weight of the slack in the sum."""
        return AT_AN_END if self.row.where in (Where.START, Where.END) else 1.0


@dataclass(frozen=True)
class _RelaxedConstraint(Constraint):
    """A constraint relaxed by slacks, which are parameters of the phase: c + w s >= l and c - w s <= u."""

    entries: tuple[_RelaxedRow, ...]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Return one row for every finite side."""
        sides = [
            (i, sign, Row(entry.row.name, entry.row.unit, lower, upper, entry.row.joint))
            for i, entry in enumerate(self.entries)
            for sign, lower, upper in ((1.0, entry.row.lower, np.inf), (-1.0, -np.inf, entry.row.upper))
            if np.isfinite(lower) or np.isfinite(upper)
        ]
        table, rows = self.entries[0].table, [entry.row for entry in self.entries]

        def expression(point: Point) -> list[ca.SX]:
            values = table.values(rows, point)
            slacks = [entry.rate * point.p[entry.name] for entry in self.entries]
            return [values[i] + sign * slacks[i] for i, sign, _ in sides]

        bound = self._bound
        return BoundConstraint(bound.name, tuple(row for *_, row in sides), expression, bound.where)

    @property
    def _bound(self) -> BoundConstraint:
        return self.entries[0].table.constraints[self.entries[0].row.constraint]

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables that the rows of the constraint read."""
        source = self._bound.source
        return dynamics if source is None else source.augment(dynamics)


def relaxed_motion(
    problem: Problem, solve: Solve, guess: InitialGuess | Solution | None = None
) -> tuple[Solution | None, tuple[Conflict, ...]]:
    """Return the motion of the relaxed problem, and the rows that it relaxes.

    Parameters
    ----------
    problem : Problem
    solve : callable
        ``solve(problem, guess)``.
    guess : InitialGuess, Solution or None
        Guess of the relaxed problem.

    Returns
    -------
    motion : Solution or None
        Solution of the relaxed problem, or its iterate after an interrupt; None if it was not solved.
    conflicts : tuple of Conflict
        Largest relative slack first. They are empty if the motion satisfies every row without a slack.
    """
    try:
        found, entries, slacks = _least_relaxed(problem, solve, guess, {})
    except RobotrajError:
        return None, ()
    if not found.success and not _meets_rows(found, slacks):
        return (found if found.status is Status.INTERRUPTED else None), ()
    if sum(value > SMALL for value in slacks.values()) > 1:
        weights = {
            entry.name: SMALL * entry.weight / (slacks[entry.name] + SMALL)
            for of_phase in entries
            for entry in of_phase
        }
        again, _, fewer = _least_relaxed(problem, solve, found, weights)
        if again.success or _meets_rows(again, fewer):
            found, slacks = again, fewer
    listed = [
        _conflict(found, i, entry, slacks[entry.name])
        for i, of_phase in enumerate(entries)
        for entry in of_phase
        if slacks[entry.name] > SMALL
    ]
    return found, tuple(sorted(listed, key=lambda conflict: -conflict.relative))


def motion_near(problem: Problem, solve: Solve, guess: InitialGuess | Solution | None) -> tuple[Solution | None, bool]:
    """Return the relaxed problem's motion of the least sum or its last iterate, and whether it meets every row."""
    try:
        found, _, slacks = _least_relaxed(problem, solve, guess, {})
    except RobotrajError:
        return None, False
    return found, _meets_rows(found, slacks)


def sufficient_duration(problem: Problem, solve: Solve, motion: Solution) -> Conflict | None:
    """Return the least duration [s] with which the rows of a single phase hold; None if none was found.

    Parameters
    ----------
    problem : Problem
    solve : callable
        ``solve(problem, guess)``.
    motion : Solution
        Solution of the relaxed problem, the guess for a longer one.
    """
    phase = problem.phases[0]
    longest = phase.duration_bounds[1]
    if len(problem.phases) > 1 or not np.isfinite(longest) or longest <= 0.0:
        return None
    try:
        longer = phase.with_(duration=(longest, LONGEST * longest), objective=Duration())
        found = solve(Problem([longer], problem.links), motion)
    except RobotrajError:
        return None
    if not found.success:
        return None
    needed = found.duration
    relative = needed / longest - 1.0
    if relative < SMALL:
        return None
    enough = with_room(longest, needed, ROOM_OF_DURATION)
    return Conflict(phase.name, "duration", enough, longest, enough, "s", relative, True, "alone suffices")


def _least_relaxed(
    problem: Problem, solve: Solve, guess: InitialGuess | Solution | None, weights: Mapping[str, float]
) -> tuple[Solution, list[list[_RelaxedRow]], dict[str, float]]:
    """Solve the relaxed problem for the least weighted sum; return its solution, its relaxed rows and their slacks."""
    relaxed, entries = _relaxed(problem, weights)
    found = solve(relaxed, guess)
    return found, entries, _slacks(found, entries)


def _meets_rows(found: Solution, slacks: Mapping[str, float]) -> bool:
    """Whether a solve has come to a motion without slacks, even if it ended at its iteration limit."""
    ended = found.success or (found.status is Status.ITERATION_LIMIT and not found.violation_list)
    return ended and all(value <= SMALL for value in slacks.values())


def _relaxed(problem: Problem, weights: Mapping[str, float]) -> tuple[Problem, list[list[_RelaxedRow]]]:
    """Return the relaxed problem, and the relaxed rows of each phase."""
    phases, relaxed_rows = [], []
    for i, phase in enumerate(problem.phases):
        # Contacts of the phase impose their limits themselves; rows of the objective are removed with it.
        given = [bound for bound in phase.rows.constraints if bound.source is not None]
        dae = phase.body
        for constraint in phase.constraints:
            dae = constraint.augment(dae)
        table = replace(phase.rows, dae=dae, constraints=tuple(given))
        # A path is the motion that is planned, not a limit of it.
        kept = [n for n, bound in enumerate(given) if bound.where in KEPT or isinstance(bound.source, FollowPath)]
        longest = next((bound for bound in phase.duration_bounds[::-1] if 0.0 < bound < np.inf), 1.0)
        entries = [
            _RelaxedRow(table, row, f"slack.{i}.{row.number}", longest if row.where is Where.INTEGRAL else 1.0)
            for row in table
            if row.constraint not in kept
        ]
        of_each = groupby(entries, lambda entry: entry.row.constraint)
        wrapped: list[Constraint] = [_RelaxedConstraint(tuple(group)) for _, group in of_each]
        wrapped += [source for n in kept if (source := given[n].source) is not None]
        names = [entry.name for entry in entries]
        sizes = [weights.get(entry.name, entry.weight) for entry in entries]
        cost: Objective = Mayer(partial(_total, names=names, weights=sizes))
        phases.append(
            phase.with_(
                limits=None,
                states={},
                controls={},
                algebraic={},
                constraints=wrapped,
                objective=cost,
                parameters={**phase.parameters, **{name: between(0.0, None) for name in names}},
            )
        )
        relaxed_rows.append(entries)
    return Problem(phases, problem.links), relaxed_rows


def _total(start: Point, end: Point, names: Sequence[str], weights: Sequence[float]) -> ca.SX:
    """Return the sum of the weighted slacks."""
    return ca.sum1(ca.vertcat(0, *(weight * end.p[name] for name, weight in zip(names, weights, strict=True))))


def _slacks(found: Solution, relaxed: Sequence[Sequence[_RelaxedRow]]) -> dict[str, float]:
    return {
        entry.name: part.parameters[entry.name]
        for part, entries in zip(found.phases, relaxed, strict=True)
        for entry in entries
    }


def _conflict(found: Solution, index: int, entry: _RelaxedRow, slack: float) -> Conflict:
    """Return the time at which a relaxed row is furthest beyond its bounds, and a bound that suffices."""
    part = found.phases[index]
    phase: Phase = part.phase
    p = np.array([part.parameters[name] for name in entry.table.parameters])
    times = {Where.START: part.points[:1], Where.END: part.points[-1:]}.get(
        entry.row.where, np.unique(np.append(part.points, part.knots))
    )
    x, z, u = (curve(times) for curve in (part.trajectory.x, part.trajectory.z, part.trajectory.u))
    values = entry.table.sample((entry.row,), times, x, z, u, p)[:, 0]
    if entry.row.where is Where.INTEGRAL:
        slack *= part.duration / entry.duration
        times, values = times[-1:], np.array([np.trapezoid(values, times)])
    low, high = entry.row.lower - values, values - entry.row.upper
    worst = int(np.argmax(np.maximum(low, high)))
    upper = bool(high[worst] >= low[worst])
    bound = entry.row.upper if upper else entry.row.lower
    amount = slack * entry.scale
    needed = with_room(bound, bound + amount if upper else bound - amount)
    return Conflict(
        phase.name,
        entry.row.label,
        float(times[worst]),
        entry.row.shown(bound),
        entry.row.shown(needed),
        entry.row.shown_unit,
        slack,
        entry.row.kind is Kind.BOUND or entry.row.joint in _joints(phase),
    )


def _joints(phase: Phase) -> tuple[str, ...]:
    return phase.robot.velocity_names if phase.robot is not None else ()
