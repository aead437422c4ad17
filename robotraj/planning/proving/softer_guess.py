"""Solves with softer friction, whose solutions are guesses of a solve with less soft friction.

A proved plan meets its friction step by step, on finer and finer meshes (``planning.loop``). A solve on a given mesh
meets it by the same steps there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from robotraj.fixed_mesh.solve import solve
from robotraj.fixed_mesh.warm_start import PATIENCE, separated_form
from robotraj.planning.proving.soft_friction import averaging_times, nearer, softened, softening_of
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.proof import Goals
from robotraj.solution.records import started_from, with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.transcription.clearance.surface_rows import NearSurfaces
from robotraj.transcription.transcribe import meshes_of


def solved_softer(
    problem: Problem,
    factor: float,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    surfaces: Sequence[NearSurfaces | None] = (),
) -> Solution:
    """Solve a problem briefly with the soft friction of c = ``factor``, on the mesh of the settings."""
    meshes = meshes_of(problem, settings.mesh)
    near = replace(
        settings,
        restarts=Restarts(0),
        interval_limits=replace(settings.interval_limits, rounds=0),
        solver=settings.solver.at_most(PATIENCE).until_settled((settings.goals or Goals()).objective),
    )
    last = guess if isinstance(guess, Solution) else None
    soft = softened(problem, factor, averaging_times(problem, meshes, last))
    found = solve(soft, guess, near, progress, surfaces=surfaces)
    return replace(found, rounds=started_from(found.rounds, f"softer friction, {factor:g}"))


def from_softer(find: Callable[..., Solution]) -> Callable[..., Solution]:
    """Return a method of planning that meets dry friction by softer one, where joints stick and slide.

    A guess that is a solution is kept.
    """

    def planned(
        problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
    ) -> Solution:
        softening = [] if isinstance(guess, Solution) else list(softening_of(problem))
        start, spent = guess, None
        form = separated_form(problem, settings.mesh, guess)
        apart = settings if form is None else replace(settings, mesh=form[1])
        while softening:
            found = solved_softer(problem, softening[0], start, apart, progress)
            spent = found if spent is None else with_effort_of(spent, found)
            if found.success:
                start = found
                softening.pop(0)
                continue
            between = nearer(softening[0], start)
            if between is None:
                break
            softening.insert(0, between)
        warm = settings.solver if start is guess else settings.solver.from_nearby(altered=True)
        solution = find(problem, start, replace(settings, solver=warm), progress)
        return solution if spent is None else with_effort_of(spent, solution)

    return planned
