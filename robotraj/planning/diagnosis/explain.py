"""Why a plan failed: the conflicts of its limits.

The cheapest check comes first: slopes that are too steep and jumps that are too long for the friction, ends without a
configuration, torques too small to hold an end, then the relaxed problem on a coarse mesh. Where that has a
motion but the plan has none, a finer mesh decides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj.planning.diagnosis.blocked_ends import blocked_ends
from robotraj.planning.diagnosis.elastic import Solve, relaxed_motion, sufficient_duration
from robotraj.planning.diagnosis.momentum.jumps import slipping_jumps
from robotraj.planning.diagnosis.momentum.slipping import slipping_contacts
from robotraj.planning.diagnosis.rate_limits import wider_rates
from robotraj.planning.diagnosis.undefined import undefined_expression
from robotraj.planning.diagnosis.unheld_ends import unheld_ends
from robotraj.planning.diagnosis.unreached_ends import unreached_ends
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict, are_certain
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.extract import PhaseTrajectory

UNEXPLAINED = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED, Status.ITERATION_LIMIT, Status.DIVERGED)
"""Statuses for which the relaxed problem is solved."""
SHORT_OF_TIME = ("velocity", "acceleration", "jerk", "effort", "torque rate", "control")
"""First words of the names of rows that a longer duration may satisfy."""


def against_momentum(problem: Problem) -> tuple[Conflict, ...]:
    """Return the friction that gravity and momentum alone exclude, without a solve."""
    return slipping_contacts(problem) or slipping_jumps(problem)


def completed(
    problem: Problem, conflicts: tuple[Conflict, ...], motion: Solution | None, solve_coarse: Solve
) -> tuple[Conflict, ...]:
    """Add the least duration that suffices, and prefer a limit of jerks or of rates of torques that must give less.

    Without a motion, the relaxed problem was not solved. A longer duration may suffice where limits of speeds,
    accelerations, jerks, torques or controls conflict.
    """
    if motion is not None and not conflicts:
        return ()
    rates, wider = wider_rates(problem, solve_coarse, motion)
    if rates is not None and all(rates.relative < conflict.relative for conflict in conflicts[:1]):
        conflicts, motion = (rates,), wider
    if motion is None:
        return conflicts
    if not all(conflict.name.startswith(SHORT_OF_TIME) for conflict in conflicts):
        return conflicts
    longer = sufficient_duration(problem, solve_coarse, motion)
    return conflicts if longer is None else (*conflicts, longer)


def explained(solution: Solution, solve_coarse: Solve, solve_finer: Solve) -> Solution:
    """Return a failed solution with its cause: an undefined expression, conflicts of limits, or its mesh.

    A mesh may have no motion where the problem has one. The solver then finds it infeasible, and a motion of the
    relaxed problem meets every row on another mesh. That of a coarse mesh may be none between its points, so that
    limits are in conflict where a finer mesh has to relax them.
    """
    if solution.success or solution.conflicts:
        return solution
    undefined = undefined_expression(solution)
    if undefined:
        return replace(solution, message=f"{undefined} ({solution.message})", status=Status.INVALID_NUMBER)
    if solution.status not in UNEXPLAINED:
        return solution
    conflicts, coarse = _searched(solution.problem, solve_coarse, solution)
    conflicts = conflicts or blocked_ends(solution.problem)
    on_this_mesh = solution.status is Status.INFEASIBLE and coarse is not None and not conflicts
    if on_this_mesh:
        _, finer = relaxed_motion(solution.problem, solve_finer, coarse)
        conflicts = finer if are_certain(finer) else ()
    status = Status.NOT_ON_THIS_MESH if on_this_mesh and not conflicts else solution.status
    return replace(solution, conflicts=conflicts, status=status)


def conflicts_of(
    problem: Problem,
    solve_coarse: Solve,
    start: InitialGuess | Solution | None = None,
    agreed: bool = False,
    near: Sequence[PhaseTrajectory] = (),
) -> tuple[Conflict, ...]:
    """Return the first conflicts that are found: of slopes, at the ends, of torques that hold them, of relaxed rows.

    With ``agreed``, two searches must find the same conflicts at the ends; otherwise one search suffices.
    The first search starts from the ends of ``near``, the iterate of a solver.
    """
    return _searched(problem, solve_coarse, start, agreed, near)[0]


def _searched(
    problem: Problem,
    solve_coarse: Solve,
    start: InitialGuess | Solution | None,
    agreed: bool = False,
    near: Sequence[PhaseTrajectory] = (),
) -> tuple[tuple[Conflict, ...], Solution | None]:
    """Return the first conflicts, and a motion of the relaxed problem that meets every row; None without one."""
    if isinstance(start, Solution):
        near = [part.trajectory for part in start.phases]
    found = against_momentum(problem) or unreached_ends(problem, agreed, near) or unheld_ends(problem)
    if found:
        return found, None
    motion, conflicts = relaxed_motion(problem, solve_coarse, start)
    # The relaxed problem has no rows on distances.
    kept_clear = any(each.avoids_collisions for phase in problem.phases for each in phase.constraints)
    meets_rows = motion is not None and motion.success and not conflicts and not kept_clear
    return completed(problem, conflicts, motion, solve_coarse), motion if meets_rows else None
