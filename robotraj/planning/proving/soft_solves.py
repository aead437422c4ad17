"""Solves with soft dry friction, less soft each time, of which each is the guess of the next (``soft_friction``)."""

from __future__ import annotations

from dataclasses import replace

from robotraj._util.time_left import LimitReached
from robotraj.planning.plan_limits import PlanLimits
from robotraj.planning.proving.measures import measured
from robotraj.planning.proving.soft_friction import SOFTENING, averaging_times, softened
from robotraj.planning.proving.solves import Solves
from robotraj.planning.warm_start import PATIENCE
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import are_clear
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.schemes.mesh import Mesh

CHANGE = 1e-3
"""Relative change of the objective within eight iterations below which a solve ends.

Reversals go on to move from interval to interval for up to a hundred iterations. The next solve, on other intervals,
moves them again.
"""
NEARLY = 1e-2
"""Relative violation of a row that a guess may have."""
SOFTER = 1.25
"""Least growth of the number of intervals from one soft friction to the next, less soft one."""


def soft_solution(
    problem: Problem, guess: InitialGuess | None, meshes: tuple[Mesh, ...], settings: Settings, solves: Solves
) -> Solution | None:
    """Return the guess with the least soft friction that was found; None if all solves failed.

    A time limit that ends these solves leaves the plan to the robot's own friction.
    """
    limits = replace(settings.interval_limits, rounds=0)
    solver = settings.solver.at_most(PATIENCE).until_settled(CHANGE)
    own = replace(settings, restarts=Restarts(0), interval_limits=limits, solver=solver)
    found = None
    for softening in SOFTENING:
        soft = softened(problem, softening, averaging_times(problem, meshes, found))
        try:
            softer = solves.solve(
                soft, found or guess, replace(own, mesh=meshes), name=f"softer friction, {softening:g}"
            )
        except LimitReached:
            break
        if is_guess(softer):
            found, meshes = softer, finer_where_bent(softer, settings)
        elif are_clear(softer.conflicts):
            break
    if isinstance(solves.progress, PlanLimits):
        solves.progress.begin()
    return found


def is_guess(softer: Solution) -> bool:
    """Whether a solve ended at a solution, or at the limit of its iterations with its rows nearly met."""
    if softer.status is not Status.ITERATION_LIMIT:
        return softer.success
    return all(violation.relative <= NEARLY for violation in softer.violations(1))


def finer_where_bent(soft: Solution, settings: Settings) -> tuple[Mesh, ...]:
    """Return meshes that are finer where torques bend: they bend more sharply with less soft friction."""
    if settings.refinement is None or settings.goals is None:
        return tuple(part.mesh for part in soft.phases)
    return measured(soft, None, settings.goals, bending=True).next_meshes(soft.phases, settings.refinement, SOFTER)
