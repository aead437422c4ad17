"""One solve of a transcribed problem, evaluated outside the solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj._util.time_left import LimitReached, used_time
from robotraj.fixed_mesh.checked_solution import checked_solution
from robotraj.fixed_mesh.starts import Start
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
) -> tuple[Solution, np.ndarray]:
    """Solve a transcribed problem whose building began at ``began``; also return the decision vector."""
    shared = guess.shared if isinstance(guess, Start) else None
    known = guess.multipliers if isinstance(guess, Solution) else shared.known if shared else None
    try:
        if known is not None and known.origin is not None:
            outcome = solver.resolve(nlp, known, progress, multipliers)
        else:
            outcome = solver.solve(nlp, progress, multipliers)
    except LimitReached:
        # The derivatives would take longer than the time that is left: the guess is the only iterate.
        outcome = guess_of(nlp, Status.INTERRUPTED, "no iteration was possible")
    outcome = replace(outcome, w=unwrapped(nlp, outcome.w))
    if shared is not None:
        shared.keep(nlp, outcome.multipliers)
    # Building includes all times that a solver does not count, such as for assembling the functions of the NLP.
    own = outcome.times.get("setup", 0.0) + outcome.times.get("solve", 0.0)
    times = {"build": used_time() - began - own - nlp.compiling, "compile": nlp.compiling}
    return checked_solution(nlp, outcome, times), outcome.w


def guess_of(nlp: Nlp, status: Status, message: str) -> Outcome:
    """Return the guess as the only iterate."""
    none = Multipliers(np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables)))
    return Outcome(status, message, nlp.guess, none, 0)


def conflicts_are_certain(nlp: Nlp) -> bool:
    """Whether conflicts of limits seldom depend on the guess: durations are fixed, and every joint has a motor."""
    fixed = all(layout.duration.column is None for layout in nlp.layouts)
    robots = [phase.robot for phase in nlp.problem.phases]
    return fixed and all(robot is not None and robot.nu == robot.nv for robot in robots)
