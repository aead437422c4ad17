"""One solve on one mesh: transcribe, solve, evaluate every row again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from robotraj._util.system.interrupts import stop_if_noted
from robotraj._util.time_left import used_time
from robotraj.guess.default import as_guess, default_guess
from robotraj.planning.diagnosis.exclusions.work_budgets import limits_work
from robotraj.planning.diagnosis.relaxation.coarse_settings import BRIEFLY, coarse_settings
from robotraj.planning.plan_limits import PlanLimits
from robotraj.planning.proving.clearing import Clearing
from robotraj.planning.proving.limits_between import Posed, limited_between, with_surfaces
from robotraj.planning.sizes.slack_powers import with_slack_powers
from robotraj.planning.solve_nlp import solve_nlp
from robotraj.planning.warm_start import (
    PATIENCE,
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
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Multipliers, Progress, Solver
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.added_rows import (
    rows_against_swings,
    with_added_rows,
)
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.transcribe import transcribe

if TYPE_CHECKING:
    from robotraj.planning.diagnosis.infeasibility_check import InfeasibilityCheck
    from robotraj.transcription.clearance.surface_rows import NearSurfaces


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
    posed, multipliers = _posed(problem, guess, settings, surfaces)
    check = _infeasibility_check(problem, guess, settings, progress)
    # Restarts of a plan, which have none themselves, need no second opinion.
    first = settings.restarts.count > 0 or check is not None
    solution, w = solve_nlp(posed.nlp, guess, multipliers, settings.solver, check or progress, began, first)
    if check is not None and check.conflicts:
        return replace(solution, status=Status.INFEASIBLE, conflicts=check.conflicts)
    if check is not None and check.motion is not None:
        near = replace(settings, solver=settings.solver.from_nearby())
        return with_effort_of(solution, _solve_once(problem, check.motion, near, progress, hold, lower, surfaces))
    if solution.status is Status.INTERRUPTED and not settings.interval_limits.rounds:
        # No time is left to check an interrupted iterate between its points.
        return solution
    if settings.restarts.count and not solution.success:
        try:
            solution = _restarted(posed, solution, guess, settings, progress, hold, lower)
        except KeyboardInterrupt:
            # Ctrl-C between two solves: the last solution is kept.
            return replace(solution, status=Status.INTERRUPTED, added_rows=posed.added)
        if solution.success:
            return solution
    return limited_between(posed, solution, w, settings, progress, hold, lower)


def _posed(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    surfaces: Sequence[NearSurfaces | None],
) -> tuple[Posed, Multipliers | None]:
    """Transcribe a problem with the rows of its guess; also return the multipliers of the guess that are of use."""
    mesh, limits = settings.mesh, settings.interval_limits
    start = as_guess(guess) or default_guess(problem)
    plain = earlier_program(problem, mesh, guess, settings.engine, limits, settings.smoothing) or transcribe(
        problem, mesh, with_slack_powers(start, problem), settings.engine, limits, settings.smoothing
    )
    added, same = earlier_rows(problem, mesh, guess) if limits.rounds else ([], False)
    if settings.goals is not None:
        missing = [each for each in rows_against_swings(plain) if each not in set(added)]
        added, same = [*added, *missing], same and not missing
    nlp = with_surfaces(with_added_rows(plain, added, plain.guess) if added else plain, surfaces)
    clearing = Clearing(nlp, start)
    posed = Posed(problem, clearing.rows(nlp), nlp, clearing, tuple(added), surfaces)
    extended = bool(added) and same and not any(surfaces)
    multipliers = earlier_multipliers(guess, posed.nlp if extended else plain, extended)
    if (clearing or any(surfaces) or (added and not same)) and multipliers is not None:
        multipliers = lengthened(multipliers, posed.nlp)
    return posed, multipliers


def _restarted(
    posed: Posed,
    solution: Solution,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None,
    hold: Callable[[Solution], bool] | None,
    lower: bool,
) -> Solution:
    """Solve a problem that could not be solved from its guess from other ones."""
    from robotraj.planning.restarts import restarted

    def solve_again(
        problem: Problem, start: InitialGuess | Solution | None, solver: Solver = settings.solver
    ) -> Solution:
        # Rows are added to solutions of the problem itself; other solutions are guesses.
        needs_rounds = hold if problem is posed.problem else _no_rounds
        return solve(
            problem, start, replace(settings, solver=solver, restarts=Restarts(0)), progress, needs_rounds, lower
        )

    briefly = partial(solve_again, solver=settings.solver.at_most(2 * PATIENCE))
    solve_coarse = partial(solve_relaxed, settings=settings, progress=progress)
    return restarted(solution, posed.nlp, guess, solve_again, briefly, settings.restarts, solve_coarse)


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
    own = replace(settings, solver=settings.solver.at_most(BRIEFLY), restarts=Restarts(0))
    found = solve(problem, None, own, progress, _no_rounds)
    if not found.success:
        return False
    finer = tuple(evenly_finer(part.mesh, 2.0) for part in found.phases)
    near = settings.solver.from_nearby().at_most(BRIEFLY)
    return solve(problem, found, replace(own, mesh=finer, solver=near), progress, _no_rounds).success


def _no_rounds(solution: Solution) -> bool:
    return False
