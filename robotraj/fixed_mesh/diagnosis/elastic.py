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

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import casadi as ca
import numpy as np

from robotraj._util.errors import RobotrajError
from robotraj.dynamics.point import Point
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.relaxation.relaxed_friction import RelaxedFriction, with_free_friction
from robotraj.fixed_mesh.diagnosis.relaxation.relaxed_rows import (
    RelaxedConstraint,
    RelaxedRow,
    bounds_of_robot,
    relaxed_rows,
)
from robotraj.problem.constraints.base import Constraint, Where
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.expressions import Mayer
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import NOTICED, ROOM_OF_DURATION, Conflict, with_room
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

LONGEST = 30.0
"""Longest duration that is tried, relative to the longest allowed one."""
ALONE, TOGETHER = "alone suffices", "the stated durations alone suffice"
"""Reasons of a duration, and of those of several phases, with which every row holds."""
ENDED = (Status.ITERATION_LIMIT, Status.INTERRUPTED)
"""Statuses after which no further rows are relaxed."""
KEPT = (Where.RATE,)
"""Kinds of rows that are not relaxed."""

Relaxed = RelaxedRow | RelaxedFriction
"""What has a slack."""


def relaxed_motion(
    problem: Problem, coarse: CoarseSolves, guess: InitialGuess | Solution | None = None
) -> tuple[Solution | None, tuple[Conflict, ...]]:
    """Return the motion of the relaxed problem, and the rows that it relaxes.

    Parameters
    ----------
    problem : Problem
    coarse : CoarseSolves
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
        own, found, entries, slacks = _demands_first(problem, coarse, guess)
    except RobotrajError:
        return None, ()
    if not found.success and not _meets_rows(found, slacks):
        return (found if found.status is Status.INTERRUPTED else None), ()
    if sum(value > NOTICED for value in slacks.values()) > 1:
        again, _, fewer = _least_relaxed(problem, coarse, found, slacks, own)
        if again.success or _meets_rows(again, fewer):
            found, slacks = again, fewer
    return found, _conflicts(found, entries, slacks)


def relaxed_again(problem: Problem, coarse: CoarseSolves, motion: Solution) -> tuple[Conflict, ...]:
    """Return the rows that a motion of the relaxed problem relaxes on another mesh; empty if it was not solved there.

    The sum of their slacks is weighted such that few rows are relaxed. Rows that the motion met exactly stay exact.
    """
    before = {name: value for part in motion.phases for name, value in part.parameters.items()}
    own = any(entry.name not in before for of in _relaxed(problem, {}, False)[1] for entry in of)
    try:
        found, entries, slacks = _least_relaxed(problem, coarse, motion, before, own)
    except RobotrajError:
        return ()
    return _conflicts(found, entries, slacks) if found.success else ()


def _conflicts(
    found: Solution, entries: Sequence[Sequence[Relaxed]], slacks: Mapping[str, float]
) -> tuple[Conflict, ...]:
    """Describe the rows with slacks, largest relative slack first."""
    listed = [
        entry.conflict(found.phases[i], slacks[entry.name])
        for i, of_phase in enumerate(entries)
        for entry in of_phase
        if slacks[entry.name] > NOTICED
    ]
    return tuple(sorted(listed, key=lambda conflict: -conflict.relative))


def motion_near(
    problem: Problem, coarse: CoarseSolves, guess: InitialGuess | Solution | None
) -> tuple[Solution | None, bool]:
    """Return the relaxed problem's motion of the least sum or its last iterate, and whether it meets every row."""
    try:
        found, _, slacks = _least_relaxed(problem, coarse, guess, {})
    except RobotrajError:
        return None, False
    return found, _meets_rows(found, slacks)


def sufficient_durations(problem: Problem, coarse: CoarseSolves, motion: Solution | None) -> tuple[Conflict, ...]:
    """Return the durations [s] of the least sum with which the rows hold; empty if none were found.

    Those of motions with contacts are not looked for, since a gait of other durations has other footholds.

    Parameters
    ----------
    problem : Problem
    coarse : CoarseSolves
    motion : Solution or None
        Solution of the relaxed problem, the guess for a longer one.
    """
    longest = [phase.duration_bounds[1] for phase in problem.phases]
    bounded = all(0.0 < each < np.inf for each in longest)
    if not bounded or any(phase.contacts for phase in problem.phases):
        return ()
    try:
        longer = [
            phase.with_(duration=(least, LONGEST * least), objective=Duration())
            for phase, least in zip(problem.phases, longest, strict=True)
        ]
        found = coarse.solve(Problem(longer, problem.links), motion)
    except RobotrajError:
        return ()
    if not found.success:
        return ()
    given_way = [
        (phase.name, least, part.duration)
        for phase, least, part in zip(problem.phases, longest, found.phases, strict=True)
        if part.duration / least - 1.0 >= NOTICED
    ]
    reason = ALONE if len(given_way) == 1 else TOGETHER
    listed = []
    for name, least, needed in given_way:
        enough = with_room(least, needed, ROOM_OF_DURATION)
        listed.append(Conflict(name, "duration", enough, least, enough, "s", needed / least - 1.0, True, reason))
    return tuple(sorted(listed, key=lambda conflict: -conflict.relative))


def _demands_first(
    problem: Problem, coarse: CoarseSolves, guess: InitialGuess | Solution | None
) -> tuple[bool, Solution, list[list[Relaxed]], dict[str, float]]:
    """Return whether robots' own limits hold, and what ``_least_relaxed`` returns.

    A robot's own limits are facts. What the user demands beside them gives way first. All rows are relaxed at first,
    since that leads to a motion from more guesses. Legs are so free then that solves end at their iteration limit.
    """
    legs = any(phase.contacts for phase in problem.phases)
    if legs and _asks_for_more(problem):
        asked = _least_relaxed(problem, coarse, guess, {}, own=True)
        if asked[0].success or asked[0].status in ENDED:
            return True, *asked
    found, entries, slacks = _least_relaxed(problem, coarse, guess, {})
    given_way = found.success and any(slacks[entry.name] > NOTICED for entry in _of_robots(problem, entries))
    if given_way and not legs and _asks_for_more(problem):
        asked = _least_relaxed(problem, coarse, guess, {}, own=True)
        if asked[0].success:
            return True, *asked
    return False, found, entries, slacks


def _least_relaxed(
    problem: Problem,
    coarse: CoarseSolves,
    guess: InitialGuess | Solution | None,
    before: Mapping[str, float],
    own: bool = False,
) -> tuple[Solution, list[list[Relaxed]], dict[str, float]]:
    """Solve the relaxed problem for the least weighted sum; return its solution, its relaxed rows and their slacks.

    With the slacks of a motion ``before``, the sum counts them instead of adding them up.
    """
    relaxed, entries = _relaxed(problem, before, own)
    found = coarse.solve(relaxed, guess)
    slacks = {e.name: part.parameters[e.name] for part, of in zip(found.phases, entries, strict=True) for e in of}
    return found, entries, slacks


def _of_robots(problem: Problem, entries: Sequence[Sequence[Relaxed]]) -> list[RelaxedRow]:
    """Return the relaxed rows that are limits of robots as their descriptions give them."""
    found = []
    for phase, of_phase in zip(problem.phases, entries, strict=True):
        known = bounds_of_robot(phase)
        rows = [entry for entry in of_phase if isinstance(entry, RelaxedRow)]
        found += [entry for entry in rows if known.get(entry.row.label) == (entry.row.lower, entry.row.upper)]
    return found


def _asks_for_more(problem: Problem) -> bool:
    """Whether motions of robots have further limits along their way than those of the robots."""
    along = (Where.THROUGHOUT, Where.INTEGRAL)
    robots, further = False, False
    for phase in problem.phases:
        known, table = bounds_of_robot(phase), phase.rows
        for row in table:
            if row.where in along and table.constraints[row.constraint].source is not None:
                is_own = known.get(row.label) == (row.lower, row.upper)
                robots, further = robots or is_own, further or not is_own
    return robots and further


def _meets_rows(found: Solution, slacks: Mapping[str, float]) -> bool:
    """Whether a solve has come to a motion without slacks, even if it ended at its iteration limit."""
    ended = found.success or (found.status is Status.ITERATION_LIMIT and not found.violation_list)
    return ended and all(value <= NOTICED for value in slacks.values())


def _relaxed(problem: Problem, before: Mapping[str, float], own: bool) -> tuple[Problem, list[list[Relaxed]]]:
    """Return the relaxed problem, and the relaxed rows of each phase; robots' ``own`` limits may stay exact."""
    phases: list[Phase] = []
    relaxed_of: list[list[Relaxed]] = []
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
        slacks = list(relaxed_rows(table, [row for row in table if row.constraint not in kept], f"slack.{i}", longest))
        if own:
            exact = {entry.name for entry in _of_robots(Problem([phase]), [slacks])}
            slacks = [entry for entry in slacks if entry.name not in exact]
        contacts, friction = with_free_friction(phase, f"slack.{i}.friction")
        wrapped: list[Constraint] = [] if friction is None else [friction]
        for n, bound in enumerate(given):
            rows = tuple(row for row in table if row.constraint == n)
            of_bound = tuple(entry for entry in slacks if entry.row.constraint == n)
            if n not in kept:
                wrapped.append(RelaxedConstraint(bound, table, rows, of_bound))
            elif bound.source is not None:
                wrapped.append(bound.source)
        entries: list[Relaxed] = [*slacks] if friction is None else [*slacks, friction]
        names = [entry.name for entry in entries]
        sizes = [entry.weight * (NOTICED / (before[entry.name] + NOTICED) if before else 1.0) for entry in entries]
        cost: Objective = Mayer(partial(_total, names=names, weights=sizes))
        phases.append(
            phase.with_(
                limits=None,
                states={},
                controls={},
                algebraic={},
                contacts=contacts,
                constraints=wrapped,
                objective=cost,
                parameters={**phase.parameters, **{name: between(0.0, None) for name in names}},
            )
        )
        relaxed_of.append(entries)
    return Problem(phases, problem.links), relaxed_of


def _total(start: Point, end: Point, names: Sequence[str], weights: Sequence[float]) -> ca.SX:
    """Return the sum of the weighted slacks."""
    return ca.sum1(ca.vertcat(0, *(weight * end.p[name] for name, weight in zip(names, weights, strict=True))))
