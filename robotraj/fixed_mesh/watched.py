"""An attempt that ends early where limits exclude every motion, and begins again where a motion is found beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj.fixed_mesh.at_points import AtPoints, solved_once
from robotraj.fixed_mesh.diagnosis.exclusions.work_budgets import exceeded_budgets
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.clearance.surface_rows import NearSurfaces


def watched_attempt(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    surfaces: Sequence[NearSurfaces | None] = (),
) -> AtPoints:
    """Solve a problem once from one guess, and look for conflicts meanwhile with contacts or without enough energy.

    With contacts, only a solve without restarts is watched.
    """
    known = isinstance(guess, Solution) and guess.success
    contacts = any(phase.contacts for phase in problem.phases) and not settings.restarts.count
    if known or not (contacts or exceeded_budgets(problem)):
        return solved_once(problem, guess, settings, progress, surfaces)
    from robotraj.fixed_mesh.coarse import CoarseSolves
    from robotraj.fixed_mesh.diagnosis.infeasibility_check import InfeasibilityCheck

    check = InfeasibilityCheck(problem, CoarseSolves(settings, progress), progress)
    found = solved_once(problem, guess, settings, progress, surfaces, check)
    if check.conflicts:
        return found.changed(status=Status.INFEASIBLE, conflicts=check.conflicts)
    if check.motion is None:
        return found
    near = replace(settings, solver=settings.solver.from_nearby())
    return solved_once(problem, check.motion, near, progress, surfaces).after(found.solution)
