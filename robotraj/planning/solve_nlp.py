"""One solve of a transcribed problem, whose solution is evaluated outside the solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj._util.time_left import LimitReached, used_time
from robotraj.planning.checked_solution import checked_solution
from robotraj.planning.many.starts import Start
from robotraj.planning.other_solver import solved_otherwise
from robotraj.problem.initial_guess import InitialGuess
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
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
