"""One solve of a transcribed problem, by the other solver where one fails, evaluated outside the solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj._util.time_left import LimitReached, used_time
from robotraj.fixed_mesh.checked_solution import checked_solution
from robotraj.fixed_mesh.diagnosis.closed_ways import has_closed_way
from robotraj.fixed_mesh.starts import Start
from robotraj.problem.initial_guess import InitialGuess
from robotraj.solution.records import with_effort_of
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.solvers.fallback import fall_back
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.ipopt import Ipopt
from robotraj.solvers.status import Status
from robotraj.transcription.collocation.unwrap_angles import unwrapped
from robotraj.transcription.nlp import Nlp


def solve_nlp(
    nlp: Nlp,
    guess: InitialGuess | Solution | None,
    multipliers: Multipliers | None,
    solver: Solver,
    progress: Progress | None,
    began: float,
    first: bool = False,
) -> tuple[Solution, np.ndarray]:
    """Solve a transcribed problem whose building began at ``began``; also return the decision vector.

    A ``first`` solve that ends infeasible has a second opinion, other than the restarts that follow it.
    """
    shared = guess.shared if isinstance(guess, Start) else None
    known = guess.multipliers if isinstance(guess, Solution) else shared.known if shared else None
    try:
        if known is not None and known.origin is not None:
            outcome = solver.resolve(nlp, known, progress, multipliers)
        else:
            outcome = solver.solve(nlp, progress, multipliers)
    except LimitReached:
        # The derivatives would take longer than the time that is left: the guess is the only iterate.
        none = Multipliers(np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables)))
        outcome = Outcome(Status.INTERRUPTED, "no iteration was possible", nlp.guess, none, 0, {})
    if outcome.status is Status.ITERATION_LIMIT or (first and outcome.status is Status.INFEASIBLE):
        outcome = solved_otherwise(outcome, nlp, solver, progress, multipliers)
    outcome = replace(outcome, w=unwrapped(nlp, outcome.w))
    if shared is not None:
        shared.keep(nlp, outcome.multipliers)
    # Building includes all times that a solver does not count, such as for assembling the functions of the NLP.
    own = outcome.times.get("setup", 0.0) + outcome.times.get("solve", 0.0)
    times = {"build": used_time() - began - own - nlp.compiling, "compile": nlp.compiling}
    return checked_solution(nlp, outcome, times), outcome.w


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
