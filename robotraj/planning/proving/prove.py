"""Plan until the plan is proved between its points, by Coulomb's law, with links apart and above the ground."""

from __future__ import annotations

from dataclasses import replace

from robotraj.fixed_mesh.diagnosis.self_collision import overlapping_ends
from robotraj.fixed_mesh.solve import solve
from robotraj.planning.loop.run import run
from robotraj.planning.proving.kept_apart import STOPPED, KeptApart
from robotraj.planning.proving.over_ground import above_ground
from robotraj.planning.proving.sharp_friction import sharpened
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status


def prove(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
) -> Solution:
    """Plan on finer and finer meshes until ``settings.goals`` hold, and by Coulomb's law.

    Plans whose links overlap or are below the ground are made again.

    Where links overlap at a fixed end, one iteration on the first mesh is all that is solved.
    """
    if conflicts := overlapping_ends(problem):
        once = replace(settings, solver=settings.solver.at_most(1), restarts=Restarts(0))
        return replace(solve(problem, guess, once, progress), status=Status.INFEASIBLE, conflicts=conflicts)
    found, apart = _begun(problem, guess, settings, progress)
    try:
        while (attempt := apart.next_attempt(found)) is not None:
            again = run(problem, attempt.guess, attempt.settings, progress, attempt.surfaces, attempt.is_brief)
            found = apart.kept(found, again)
        found = above_ground(found, settings, progress, apart)
        found = sharpened(found, settings, progress, apart)
    except KeyboardInterrupt:
        found = replace(found, status=Status.INTERRUPTED)
    return apart.judged(found)


def _begun(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None
) -> tuple[Solution, KeptApart]:
    """Return the first plan and what is known of overlaps. It has rows where they kept the links of the guess apart."""
    apart, spent = KeptApart(problem, settings, progress), None
    near = apart.from_guess(guess)
    if near is not None:
        spent = run(problem, near.guess, near.settings, progress, near.surfaces, near.is_brief)
        if spent.success or spent.status in STOPPED:
            return spent, apart
        apart = KeptApart(problem, settings, progress)
    found = run(problem, guess, settings, progress)
    return (found if spent is None else with_effort_of(spent, found)), apart
