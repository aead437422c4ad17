"""One solve on one mesh: transcribe, solve, evaluate every row again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.system.interrupts import stop_if_noted
from robotraj._util.time_left import LimitReached, used_time
from robotraj.guess.default import as_guess, default_guess
from robotraj.guess.from_solution import FromSolution
from robotraj.planning.checked_solution import checked_solution
from robotraj.planning.diagnosis.exclusions.work_budgets import limits_work
from robotraj.planning.diagnosis.relaxation.coarse_settings import coarse_settings
from robotraj.planning.many.starts import Start
from robotraj.planning.nlp_violations import between_points
from robotraj.planning.other_solver import solved_otherwise
from robotraj.planning.plan_limits import PlanLimits
from robotraj.planning.proving.clearing import ROUGH_SHORTFALL, ROUNDS, Clearing
from robotraj.planning.proving.lowered_limits import LoweredLimits
from robotraj.planning.sizes.slack_powers import with_slack_powers
from robotraj.planning.warm_start import (
    earlier_multipliers,
    earlier_program,
    earlier_rows,
    from_separated_form,
    lengthened,
    separated_form,
)
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import alike
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.collocation.unwrap_angles import unwrapped
from robotraj.transcription.interval_limits.added_rows import (
    exceeded_although_added,
    rows_against_swings,
    rows_to_add,
    with_added_rows,
)
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation, state_violations
from robotraj.transcription.interval_limits.margins import with_margins
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.reuse import continued_at
from robotraj.transcription.schemes.mesh import MovingMesh
from robotraj.transcription.transcribe import transcribe

if TYPE_CHECKING:
    from robotraj.planning.diagnosis.infeasibility_check import InfeasibilityCheck
    from robotraj.transcription.clearance.surface_rows import NearSurfaces

STATED, TWICE = 200, 2.0
"""Largest number of iterations of a solve with stated values, and the growth of the mesh for the second one."""


def solve(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    hold: Callable[[Solution], bool] | None = None,
    lower: bool = False,
    surfaces: Sequence[NearSurfaces | None] = (),
) -> Solution:
    """Solve a problem on a mesh and check the solution outside the solver.

    Rows of the state that the solution violates between its collocation points are added there by
    ``settings.interval_limits``. The problem is then solved again from the last solution. Added rows of a guess are
    kept on the intervals that both meshes have. If the problem cannot be solved with further rows, the solution
    without them is returned. Its ``interval_violations`` lists the violated rows.

    A problem that cannot be solved from its guess is solved from other ones (``robotraj.planning.restarts``). A problem
    in compressed form starts from the solution of its separated form (``robotraj.planning.warm_start``).

    Parameters
    ----------
    problem : Problem
    guess : InitialGuess, Solution or None
    settings : Settings
    progress : callable, optional
        Called once an iteration; a ``PlanLimits`` also before the solve.
    hold : callable, optional
        Returns whether limits between the points are imposed after a first solution; by default they always are.
        Without them, distances may fall short by ``ROUGH_SHORTFALL``.
    lower : bool
        Whether limits of controls that the motion exceeds between the points are lowered there (``margins``).
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    """
    form = separated_form(problem, settings.mesh, guess)
    if form is not None:
        problem, meshes = form

        def solve_separated(own: Settings) -> Solution:
            return _solve_once(problem, guess, replace(own, mesh=meshes), progress, hold, lower, surfaces)

        def solve_compressed(first: Solution, own: Settings) -> Solution:
            return _solve_once(problem, first, own, progress, hold, lower, surfaces)

        return from_separated_form(settings, solve_separated, solve_compressed)
    return _solve_once(problem, guess, settings, progress, hold, lower, surfaces)


def _solve_once(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None,
    hold: Callable[[Solution], bool] | None,
    lower: bool,
    surfaces: Sequence[NearSurfaces | None],
) -> Solution:
    stop_if_noted()
    if isinstance(progress, PlanLimits):
        progress.before_solve(problem, settings.mesh)
    began = used_time()
    mesh, solver, engine = settings.mesh, settings.solver, settings.engine
    interval_limits, smoothing = settings.interval_limits, settings.smoothing
    start = as_guess(guess) or default_guess(problem)
    nlp = earlier_program(problem, mesh, guess, engine, interval_limits, smoothing) or transcribe(
        problem, mesh, with_slack_powers(start, problem), engine, interval_limits, smoothing
    )
    added, same = earlier_rows(problem, mesh, guess) if interval_limits.rounds else ([], False)
    plain = nlp
    if settings.goals is not None:
        missing = [each for each in rows_against_swings(nlp) if each not in set(added)]
        added, same = [*added, *missing], same and not missing
    if added:
        nlp = with_added_rows(nlp, added, nlp.guess)
    nlp = _with_surfaces(nlp, surfaces)
    clearing, margins = Clearing(nlp, start), LoweredLimits()
    without_clearance, nlp = nlp, clearing.rows(nlp)
    extended = added and same and not any(surfaces)
    multipliers = earlier_multipliers(guess, nlp if extended else plain, bool(extended))
    if (clearing or any(surfaces) or (added and not same)) and multipliers is not None:
        multipliers = lengthened(multipliers, nlp)
    check = _infeasibility_check(problem, guess, settings, progress)
    # Restarts of a plan, which have none themselves, need no second opinion.
    first = settings.restarts.count > 0 or check is not None
    solution, w = _solve(nlp, guess, multipliers, solver, check or progress, began, first)
    if check is not None and check.conflicts:
        return replace(solution, status=Status.INFEASIBLE, conflicts=check.conflicts)
    if check is not None and check.motion is not None:
        near = replace(settings, solver=solver.from_nearby())
        return with_effort_of(solution, _solve_once(problem, check.motion, near, progress, hold, lower, surfaces))
    if solution.status is Status.INTERRUPTED and not interval_limits.rounds:
        # No time is left to check an interrupted iterate between its points.
        return solution
    try:
        if settings.restarts.count and not solution.success:
            from robotraj.planning.restarts import PATIENCE as PATIENCE_OF_VARIATIONS
            from robotraj.planning.restarts import restarted

            def solve_again(
                posed: Problem, start: InitialGuess | Solution | None, solver: Solver = settings.solver
            ) -> Solution:
                # Rows are added to solutions of the problem itself; other solutions are guesses.
                needs_rounds = hold if posed is problem else _no_rounds
                own = replace(settings, solver=solver, restarts=Restarts(0))
                return solve(posed, start, own, progress, needs_rounds, lower)

            briefly = partial(solve_again, solver=settings.solver.at_most(PATIENCE_OF_VARIATIONS))
            solve_coarse = partial(solve_relaxed, settings=settings, progress=progress)
            solution = restarted(solution, nlp, guess, solve_again, briefly, settings.restarts, solve_coarse)
            if solution.success:
                return solution
        found = _state_violations(solution, interval_limits.tolerance)
        moving = any(isinstance(layout.mesh, MovingMesh) for layout in nlp.layouts)
        clearing.measure(solution, clearing.binds(nlp, w))
        held = exceeded_although_added(nlp, found, added) if lower else []
        margins.measure(solution, held)
        limited = hold is None or hold(solution)
        rounds = interval_limits.rounds if limited else 0
        allowed = 0.0 if rounds else ROUGH_SHORTFALL
        for number in range(max(rounds, ROUNDS if clearing or lower else 0)):
            new = rows_to_add(nlp, [each for each in found if each not in held], added) if number < rounds else []
            exceeded = lower and limited and bool(margins.found)
            settled = clearing.settled_after_rise if interval_limits.rounds else clearing.settled
            if not (new or exceeded or not clearing.proved(allowed) or not settled) or not solution.success:
                break
            began = used_time()
            if moving:
                # Knots start again from those of the mesh, since moved knots stay on the arcs that they have reached.
                last = FromSolution(solution)
                without_clearance = transcribe(problem, mesh, last, engine, interval_limits, smoothing)
                without_clearance = with_added_rows(without_clearance, [*added, *new], without_clearance.guess)
                without_clearance = _with_surfaces(without_clearance, surfaces)
            else:
                without_clearance = (
                    with_added_rows(without_clearance, new, w) if new else continued_at(without_clearance, w)
                )
            if exceeded:
                margins.lower()
            # The program is built again where distances have further rows or other planes, not where bounds change.
            rebuilt = bool(clearing) and (bool(new) or not clearing.proved(allowed) or not settled)
            base = without_clearance if rebuilt or new or not clearing else continued_at(nlp, w)
            nlp = with_margins(base, margins.amounts)
            nlp = clearing.rows(nlp) if rebuilt else nlp
            warm = solver.from_nearby() if clearing or lower else solver
            # Rows that are added between the points come before those on distances, whose numbers change.
            alike = not clearing or (clearing.numbered and not new and not moving)
            known = earlier_multipliers(solution, nlp, True) if alike else None
            again, w = _solve(nlp, solution, known, warm, progress, began)
            failed = not again.success and again.status is not Status.INTERRUPTED
            solution = with_effort_of(again, solution) if failed else with_effort_of(solution, again)
            if failed or not again.iterations:
                # A solve that ends where it starts changes nothing: further margins of this size would not either.
                break
            added += new
            found = _state_violations(solution, interval_limits.tolerance)
            clearing.measure(solution, clearing.binds(nlp, w))
            held = exceeded_although_added(nlp, found, added) if lower else []
            margins.measure(solution, held)
        left = (*clearing.violations(solution), *between_points(problem, found))
    except KeyboardInterrupt:
        # Ctrl-C between two solves: the last solution is kept.
        return replace(solution, status=Status.INTERRUPTED, added_rows=tuple(added))
    controls = margins.violations(problem)
    return replace(solution, added_rows=tuple(added), interval_violations=left, control_interval_violations=controls)


def _with_surfaces(nlp: Nlp, surfaces: Sequence[NearSurfaces | None]) -> Nlp:
    if not any(surfaces):
        return nlp
    from robotraj.transcription.clearance.surface_rows import with_surface_rows

    return with_surface_rows(nlp, surfaces)


def _infeasibility_check(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None
) -> InfeasibilityCheck | None:
    """Return the callback that checks a first solve with limits of work or with contacts; None for other solves.

    With contacts, only a solve without restarts is checked.
    """
    known = isinstance(guess, Solution) and guess.success
    relaxed = isinstance(settings.solver, InteriorPoint) and settings.solver.fallback is None
    contacts = any(phase.contacts for phase in problem.phases) and not settings.restarts.count
    if known or relaxed or not (contacts or any(map(limits_work, problem.phases))):
        return None
    from robotraj.planning.diagnosis.infeasibility_check import InfeasibilityCheck

    coarse = partial(solve_relaxed, settings=settings, progress=progress)
    return InfeasibilityCheck(problem, coarse, partial(coarse, finer=True), progress)


def solve_relaxed(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    finer: bool = False,
) -> Solution:
    """Solve a relaxed problem once on few intervals, or on ``finer`` ones of a higher order."""
    return solve(problem, guess, coarse_settings(problem, settings, finer), progress)


def has_motion(problem: Problem, settings: Settings, progress: Progress | None = None) -> bool:
    """Whether a brief solve on the mesh of the settings finds a motion, and another one near it on a finer mesh.

    Where durations are free, the fastest motion is looked for. What a long one does quickly falls between the points.
    """
    free = [low < high for low, high in (phase.duration_bounds for phase in problem.phases)]
    fastest = [
        phase.with_(objective=Duration()) if is_free else phase
        for phase, is_free in zip(problem.phases, free, strict=True)
    ]
    problem = Problem(fastest, problem.links)
    own = replace(settings, solver=settings.solver.at_most(STATED), restarts=Restarts(0))
    found = solve(problem, None, own, progress, _no_rounds)
    if not found.success:
        return False
    finer = tuple(evenly_finer(part.mesh, TWICE) for part in found.phases)
    near = settings.solver.from_nearby().at_most(STATED)
    return solve(problem, found, replace(own, mesh=finer, solver=near), progress, _no_rounds).success


def _no_rounds(solution: Solution) -> bool:
    return False


def _state_violations(solution: Solution, allowed: float) -> list[IntervalViolation]:
    """Find rows of the state that are violated between the collocation points."""
    return [
        violation
        for i, part in enumerate(solution.phases)
        for violation in state_violations(part.phase, i, part.trajectory, allowed, alike(part, solution.phases))
    ]


def _solve(
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
