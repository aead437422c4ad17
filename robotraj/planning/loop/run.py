"""The loop of a plan on several meshes: solve what the state holds, measure it, respond, until the plan ends.

A time limit or Ctrl-C ends the loop here and nowhere else. The best motion so far is then the plan.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.time_left import LimitReached
from robotraj.fixed_mesh.between.limits_between import limited_between
from robotraj.fixed_mesh.plan_limits import PlanLimits
from robotraj.fixed_mesh.solve import solved_at_points
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.planning.loop.local_optimum import gain_from, is_converged
from robotraj.planning.loop.measures import Measured, measured
from robotraj.planning.loop.respond import is_limited, own_friction, respond
from robotraj.planning.loop.state import Found, PlanEnd, PlanState, Task, begin
from robotraj.planning.loop.to_tolerance import solved_to_tolerance
from robotraj.planning.loop.tolerance_state import ToleranceState
from robotraj.planning.proving.free_solution import SHALLOW
from robotraj.planning.proving.own_overlaps import OVERLAPS, OwnOverlaps
from robotraj.planning.proving.soft_friction import factor_of
from robotraj.planning.proving.softer_guess import solved_softer
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import Lack, answered, with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import SMALL_BARRIER, Progress, Solver
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.clearance.surface_rows import NearSurfaces

Surfaces = Sequence["NearSurfaces | None"]
"""For each phase, links of the robot that rows keep apart."""
NEARLY = 1e-2
"""Relative violation of a row that a guess may have."""


def run(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    surfaces: Surfaces = (),
    is_brief: bool = False,
) -> Solution:
    """Plan on finer and finer meshes until ``settings.goals`` hold, or the errors are within ``settings.tolerance``.

    Parameters
    ----------
    problem : Problem
    guess : InitialGuess, Solution or None
    settings : Settings
        With goals or a tolerance, and a refinement.
    progress : callable, optional
    surfaces : sequence of NearSurfaces or None
    is_brief : bool
        Whether the plan ends with the first solve that fails.

    Returns
    -------
    Solution
        Where a finer mesh cannot be solved, it is the solution on the coarser one. With goals it has ``proof``, and its
        status is ``Status.NOT_PROVED`` if it is no motion within its limits. Where the errors exceed a tolerance, the
        status is ``Status.TOLERANCE_NOT_REACHED``.
    """
    state: PlanState | ToleranceState | PlanEnd = _begun(begin(problem, guess, settings, is_brief))
    spent: Solution | None = None
    while not isinstance(state, PlanEnd):
        softer = isinstance(state, PlanState) and state.task is Task.SOFTER
        try:
            found = solved(state, progress, surfaces)
        except KeyboardInterrupt as stop:
            if not (softer and isinstance(stop, LimitReached)):
                if spent is None or (state.best is None and state.failed is None):
                    raise
                return _interrupted(state, spent)
            state = _at_last(state, progress)
            continue
        spent = found.solution if spent is None else with_effort_of(spent, found.solution)
        if found.solution.status is Status.INTERRUPTED:
            if not softer:
                return _interrupted(replace(state, failed=found.solution), spent)
            state = _at_last(state, progress)
            continue
        state = respond(state, found)
        lacked = ", ".join(map(str, found.lacks)) if found.solution.success else found.solution.status.value
        response = ": ".join(filter(None, ("end", state.why))) if isinstance(state, PlanEnd) else state.why
        spent = replace(spent, rounds=answered(spent.rounds, lacked, response))
    assert spent is not None
    return _with_effort(state.solution, spent)


def _begun(state: PlanState | ToleranceState) -> PlanState | ToleranceState | PlanEnd:
    """Return the state after the solve with the softest friction where the guess is its solution."""
    if not isinstance(state, PlanState) or not isinstance(state.guess, Solution):
        return state
    if not state.softening or factor_of(state.guess) != state.softening[0]:
        return state
    assert state.settings.goals is not None
    return respond(state, Found(state.guess, measured(state.guess, None, state.settings.goals, bending=True)))


def _at_last(state: PlanState | ToleranceState, progress: Progress | None) -> PlanState:
    """Return the state with the robot's own friction, which is solved whatever the clock reads."""
    if isinstance(progress, PlanLimits):
        progress.begin()
    assert isinstance(state, PlanState)
    return own_friction(state)


def _interrupted(state: PlanState | ToleranceState, spent: Solution) -> Solution:
    return _with_effort(replace(state.kept, status=Status.INTERRUPTED), spent)


def _with_effort(solution: Solution, spent: Solution) -> Solution:
    """Return a solution with the effort of the whole plan."""
    return replace(solution, times=spent.times, iterations=spent.iterations, rounds=spent.rounds)


def solved(state: PlanState | ToleranceState, progress: Progress | None = None, surfaces: Surfaces = ()) -> Found:
    """Solve what a state holds, and measure the solution."""
    if isinstance(state, ToleranceState):
        return solved_to_tolerance(state, progress)
    if state.task is Task.SOFTER:
        return _softer(state, progress, surfaces)
    if state.task is Task.AGAIN:
        return _again(state, progress)
    settings, best = replace(state.settings, mesh=state.meshes, solver=_solver(state)), state.best
    if state.only_unsettled:
        settings = replace(settings, solver=settings.solver.at_most(2 * PATIENCE), restarts=Restarts(0))
    if best is None and not state.approximates and not state.afresh:
        # Other guesses were tried on the first mesh.
        settings = replace(settings, restarts=Restarts(0))
    if state.approximates and not state.traits.full_friction:
        # The first mesh only finds a guess for the next one.
        plain = replace(settings, interval_limits=replace(settings.interval_limits, rounds=0))
        attempt = solved_at_points(state.problem, state.begin, plain, progress, surfaces)
        return _measured(state, limited_between(attempt, plain, progress), False)
    attempt = solved_at_points(state.problem, state.begin, settings, progress, surfaces)
    if not attempt.solution.success or is_limited(state):
        solution = limited_between(attempt, settings, progress, lower=True)
        return _measured(state, solution, True)
    try:
        measures = _measures(state, attempt.solution)
    except KeyboardInterrupt:
        # Ctrl-C after a solve: its solution is kept.
        return Found(replace(attempt.solution, status=Status.INTERRUPTED))
    proof = measures.proof
    fine = proof.error <= proof.goals.error and measures.growth <= 1.0
    # Twice a limit is no motion that lower limits correct: it needs a finer mesh.
    settled = (fine or state.traits.full_friction) and proof.excess <= 1.0
    solution = limited_between(attempt, settings, progress, settled, lower=True)
    if solution.success and solution.phases is attempt.solution.phases:
        return _found(solution, measures.with_violations(solution), settled)
    return _measured(state, solution, settled)


def _measures(state: PlanState, solution: Solution) -> Measured:
    """Measure a solution; without a coarser mesh, its objective still has to gain what the neighbour's had."""
    before = None if state.best is None else state.best.measures
    if before is not None and state.task is not Task.MESH:
        before = before.before
    expected = np.inf if state.neighbour is None else state.neighbour.unsettled
    assert state.settings.goals is not None
    return measured(solution, before, state.settings.goals, state.traits.sticking, expected)


def _measured(state: PlanState, solution: Solution, limited: bool) -> Found:
    if not solution.success:
        return Found(solution)
    return _found(solution, _measures(state, solution), limited)


def _found(solution: Solution, measures: Measured, limited: bool) -> Found:
    """Return a measured solution."""
    proof = measures.proof
    return Found(solution, measures, limited, proof.lacks, not is_converged(solution, proof.goals))


def _softer(state: PlanState, progress: Progress | None, surfaces: Surfaces) -> Found:
    """Solve with softer friction, as the guess of a solve with less soft friction."""
    goals, settings = state.settings.goals, replace(state.settings, mesh=state.meshes)
    assert goals is not None
    found = solved_softer(state.problem, state.softening[0], state.guess, settings, progress, surfaces)
    if not is_guess(found):
        return Found(found)
    measures = measured(found, None, goals, bending=True)
    if state.is_brief or any(surfaces) or factor_of(state.guess) > 0.0:
        return Found(found, measures)
    # A motion around itself is other than one that overlaps, so it is looked for before friction becomes less soft.
    deep = OwnOverlaps(state.problem).deepest_sampled(found) if found.success else 0.0
    lacks = (Lack(OVERLAPS, deep, SHALLOW),) if deep > SHALLOW else ()
    return Found(found, measures, lacks=lacks)


def is_guess(softer: Solution) -> bool:
    """Whether a solve ended at a solution, or at the limit of its iterations with its rows nearly met."""
    if softer.status is not Status.ITERATION_LIMIT:
        return softer.success
    return all(violation.relative <= NEARLY for violation in softer.violations(1))


def _again(state: PlanState, progress: Progress | None) -> Found:
    """Solve once more from a plan that holds, on the first mesh; what that gains, the plan has missed."""
    assert state.best is not None and state.first is not None and state.settings.goals is not None
    unseen = progress.unseen if isinstance(progress, PlanLimits) else None
    goals = state.settings.goals
    found, gained = gain_from(state.best.solution, state.first.solution, goals, _cold(state), unseen)
    lacks = (Lack("objective gained on the first mesh", gained, goals.objective),) if gained > goals.objective else ()
    return Found(found, lacks=lacks, gained=gained)


def _cold(state: PlanState) -> Solver:
    """Return the solver of a solve from a guess, which ends where its objective is flat.

    So does that of a proved motion whose objective alone has not settled.

    Times at which joints reverse and powers change their sign move from point to point. That gains little in hundreds
    of iterations, and the next mesh moves them again. With both, most of the gain is power between the points, which
    the sum that is minimised does not see. Powers alone gain a tenth of the goal in a hundred iterations. In least time
    against dry friction, slow joints that do not decide the time reverse now and then, and nothing is gained at all.
    """
    traits, goals = state.traits, state.settings.goals
    assert goals is not None
    if not (traits.sticking or traits.kinked or traits.rubbing or state.only_unsettled):
        return state.settings.solver
    share = 3.0 if traits.sticking_powers else 1.0 if traits.sticking else 0.1
    return state.settings.solver.until_settled(share * goals.objective)


def _solver(state: PlanState) -> Solver:
    """Return the solver of the next solve."""
    cold, traits = _cold(state), state.traits
    if state.best is None and state.is_softened:
        return cold.from_nearby(altered=True)
    if state.best is None and (state.neighbour is None or traits.sticking):
        return cold
    # Limits of rates are active nearly everywhere in least time. Lower and upper ones alternate with the mesh,
    # as the signs of powers do.
    warm = cold.from_nearby(altered=traits.kinked or any(phase.rows.rates for phase in state.problem.phases))
    if traits.sticking_powers and isinstance(warm, InteriorPoint):
        # A larger barrier raises the objective by a fifth, and takes a hundred iterations to lower it again.
        return replace(warm, initial_barrier=SMALL_BARRIER)
    return warm
