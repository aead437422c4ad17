"""The guess of a solve on one mesh, where joints stick and slide: the solution with softer friction before.

A proved plan meets its friction step by step, on finer and finer meshes (``planning.loop``). A solve on a given mesh
meets it by the same steps there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from robotraj.planning.proving.soft_friction import CHANGE_STICKING, averaging_times, softened, softening_of
from robotraj.planning.sizes.shares import shares_of
from robotraj.planning.solve import solve
from robotraj.planning.warm_start import PATIENCE
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import started_from, with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.transcription.schemes.mesh import Mesh


def softer_guess(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
) -> InitialGuess | Solution | None:
    """Return the solution with the least soft friction that is found, or else the guess.

    A guess that is a solution is kept.
    """
    if isinstance(guess, Solution) or not shares_of(problem).sticking:
        return guess
    meshes = (settings.mesh,) * len(problem.phases) if isinstance(settings.mesh, Mesh) else tuple(settings.mesh)
    near = replace(
        settings,
        restarts=Restarts(0),
        interval_limits=replace(settings.interval_limits, rounds=0),
        solver=settings.solver.at_most(PATIENCE).until_settled(CHANGE_STICKING),
    )
    last: Solution | None = None
    for factor in softening_of(problem):
        soft = softened(problem, factor, averaging_times(problem, meshes, last))
        found = solve(soft, last or guess, near, progress)
        found = replace(found, rounds=started_from(found.rounds, f"softer friction, {factor:g}"))
        found = found if last is None else with_effort_of(last, found)
        if not found.success:
            break
        last = found
    return last or guess


def from_softer(find: Callable[..., Solution]) -> Callable[..., Solution]:
    """Return a method of planning whose guess is the solution with softer friction."""

    def planned(
        problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
    ) -> Solution:
        start = softer_guess(problem, guess, settings, progress)
        if start is guess or not isinstance(start, Solution):
            return find(problem, guess, settings, progress)
        near = replace(settings, solver=settings.solver.from_nearby(altered=True))
        return with_effort_of(start, find(problem, start, near, progress))

    return planned
