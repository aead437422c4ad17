"""Why a plan failed: the conflicts of its limits, from the cheapest check to the relaxed problem.

Ends without a configuration come first, then torques that hold no end, then the relaxed problem on a coarse mesh.
"""

from __future__ import annotations

from dataclasses import replace

from robotraj.guess.base import InitialGuess
from robotraj.planning.diagnosis.elastic import Solve, enough_time, relaxed_motion
from robotraj.planning.diagnosis.undefined import undefined_expression
from robotraj.planning.diagnosis.unheld_ends import unheld_ends
from robotraj.planning.diagnosis.unreached_ends import unreached_ends
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

UNEXPLAINED = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED, Status.ITERATION_LIMIT, Status.DIVERGED)
"""Statuses for which the relaxed problem is solved."""
SURE = 2e-2
"""Relative relaxation on a coarse mesh below which a finer mesh may still have a motion."""
SHORT_OF_TIME = ("velocity", "acceleration", "effort", "control")
"""First words of the rows for which a longer duration may do instead."""


def are_sure(conflicts: tuple[Conflict, ...]) -> bool:
    """Whether a finer mesh would not do either."""
    return any(conflict.exact or conflict.relative > SURE for conflict in conflicts)


def completed(
    problem: Problem, conflicts: tuple[Conflict, ...], motion: Solution | None, coarsely: Solve
) -> tuple[Conflict, ...]:
    """Add the duration that would do instead of stronger limits."""
    if motion is None or not conflicts:
        return conflicts
    if not all(conflict.name.startswith(SHORT_OF_TIME) for conflict in conflicts):
        return conflicts
    longer = enough_time(problem, coarsely, motion)
    return conflicts if longer is None else (*conflicts, longer)


def explained(solution: Solution, coarsely: Solve) -> Solution:
    """Return a solution that was not found with the cause: an undefined expression, or conflicts of limits."""
    if solution.success or solution.conflicts:
        return solution
    undefined = undefined_expression(solution)
    if undefined:
        return replace(solution, message=f"{undefined} ({solution.message})", status=Status.INVALID_NUMBER)
    if solution.status not in UNEXPLAINED:
        return solution
    return replace(solution, conflicts=conflicts_of(solution.problem, coarsely, solution))


def conflicts_of(
    problem: Problem, coarsely: Solve, start: InitialGuess | Solution | None = None, agreed: bool = False
) -> tuple[Conflict, ...]:
    """Return the first conflicts that are found: at the ends, of torques that hold them, of the relaxed problem.

    Those at the ends are named although only one search came to them, unless they must be ``agreed``.
    """
    found = unreached_ends(problem, agreed) or unheld_ends(problem)
    if found:
        return found
    motion, conflicts = relaxed_motion(problem, coarsely, start)
    return completed(problem, conflicts, motion, coarsely)
