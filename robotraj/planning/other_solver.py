"""The other solver, where one solver fails: its failure is not that of the plan."""

from __future__ import annotations

from robotraj.planning.diagnosis.closed_ways import has_closed_way
from robotraj.solution.records import with_effort_of
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.solvers.fallback import fall_back
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.ipopt import Ipopt
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp


def conflicts_are_certain(nlp: Nlp) -> bool:
    """Whether conflicts of limits seldom depend on the guess: durations are fixed, and every joint has a motor."""
    fixed = all(layout.duration.column is None for layout in nlp.layouts)
    robots = [phase.robot for phase in nlp.problem.phases]
    return fixed and all(robot is not None and robot.nu == robot.nv for robot in robots)


def solved_otherwise(
    failed: Outcome, nlp: Nlp, solver: Solver, progress: Progress | None, multipliers: Multipliers | None
) -> Outcome:
    """Solve by the other solver what the first one did not solve; return the failed outcome where it cannot help.

    A default limit of IPOPT's iterations hands the problem to the interior-point method. A problem that this method
    finds infeasible goes to its fallback, unless other guesses would end in the same way or obstacles close the way.
    """
    if failed.status is Status.ITERATION_LIMIT and solver == Ipopt():
        found = fall_back(InteriorPoint(fallback=None), nlp, progress, None, "IPOPT ended at its iteration limit", None)
        accepted = found.status is Status.SOLVED
    elif failed.status is Status.INFEASIBLE and isinstance(solver, InteriorPoint) and solver.fallback is not None:
        if conflicts_are_certain(nlp) or has_closed_way(nlp.problem):
            return failed
        limit, reason = solver.time_limit, "the interior-point method ended with 'infeasible'"
        seconds = None if limit is None else limit - failed.times.get("solve", 0.0)
        found = fall_back(solver.fallback, nlp, progress, multipliers, reason, seconds)
        # At a limit of iterations the fallback has found nothing.
        accepted = found.status is not Status.ITERATION_LIMIT
    else:
        return failed
    return with_effort_of(failed, found) if accepted else with_effort_of(found, failed)
