"""plan(): transcribe a problem, solve it and check the solution."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError, warn
from robotraj._util.system.forks import unforked
from robotraj._util.system.interrupts import noted
from robotraj._util.time_left import LimitReached, limited
from robotraj.fixed_mesh.diagnosis.memory import shortage_named
from robotraj.fixed_mesh.diagnosis.unheld_ends import unheld_ends
from robotraj.fixed_mesh.plan_limits import PlanLimits
from robotraj.fixed_mesh.solve import solve
from robotraj.guess.default import as_guess
from robotraj.native.engines.base import Engine
from robotraj.planning.candidates import has_candidates, with_candidates
from robotraj.planning.doubtful import warn_of_doubtful
from robotraj.planning.live.terminal_line import watching
from robotraj.planning.settings import GIVEN, resolve
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.solution.errors import NoSolutionFound, PlanInterrupted
from robotraj.solution.proof import Goals
from robotraj.solution.records import ContinuationRecord
from robotraj.solution.released import released
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Solver
from robotraj.solvers.checks import above_zero
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.refinement.base import Refinement
from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from robotraj.planning.continuation import ContinuationStep
    from robotraj.replay_page.live.live_window import LiveWindow


@unforked()
def plan(
    problem: Problem | Phase,
    mesh: Mesh | Sequence[Mesh] | None = None,
    guess: InitialGuess | Solution | Sequence[InitialGuess] | None = None,
    solver: Solver | None = None,
    *,
    engine: Engine | None = None,
    tolerance: float | None = None,
    refinement: Refinement | None = None,
    continuation: Sequence[ContinuationStep] = (),
    interval_limits: ConstraintGeneration | None = None,
    restarts: Restarts | None = None,
    smoothing: float | None = None,
    goals: Goals | None = None,
    settings: Settings | None = None,
    time_limit: float | None = None,
    memory_limit: float | None = None,
    check: bool = True,
    progress: bool | None = None,
    watch: bool | LiveWindow = False,
    keep_program: bool = False,
) -> Solution:
    """Transcribe a problem, solve it and check the solution.

    The rules below decide every setting that is left open. ``solution.settings`` holds the choices with their reasons.

    Parameters
    ----------
    problem : Problem or Phase
    mesh : Mesh or sequence of Mesh, optional
        One for all phases or one for each. With ``tolerance``, the first mesh.
    guess : InitialGuess, Solution or sequence of InitialGuess, optional
        A straight line by default, the motion of an inverted pendulum for legs, and a simulation for a System whose
        end is free. ``rt.Guess(times, q=..., tau=...)`` takes arrays. A sequence has one guess for each phase. An
        earlier solution on any mesh and scheme is a warm start.
    solver : Solver, optional
        For example ``rt.InteriorPoint()``, which factorises stage by stage, or ``rt.Ipopt()``.
    engine : Engine, optional
        How point functions are evaluated. All engines agree to rounding. ``rt.engines.Native()`` and
        ``rt.engines.VirtualMachine()`` need no compiler; ``rt.engines.Compiled()`` keeps C libraries for later plans.
    tolerance : float, optional
        The mesh is refined until two measures are below this: the relative error between the knots
        (``rt.refinement.errors_of``) and the relative change of the objective. Intervals are also split where path
        constraints on controls are violated between the points, while the excess falls; the printed solution names
        the rest. Schemes of low order need many intervals. If the tolerance is not reached, the status is
        ``Status.TOLERANCE_NOT_REACHED``.
    refinement : Refinement, optional
        How meshes are refined. ``rt.refinement.SplitOrRaise()`` splits intervals or raises their order. It only splits
        those of shooting and of compressed collocation.
    continuation : sequence of ContinuationStep
        Easier problems to be solved first, such as with coarser meshes, fewer constraints or simpler objectives. Each
        solution is the guess of the next problem. The problem itself comes last.
    interval_limits : ConstraintGeneration, optional
        How rows on states and controls are imposed between the collocation points.
        ``rt.interval_limits.ConstraintGeneration()`` imposes rows on states where a solution violates them, and solves
        again. ``rt.interval_limits.BernsteinBounds()`` bounds the Bernstein coefficients of the polynomials, which is
        slightly stricter. Remaining violations are listed by ``solution.interval_violations`` and
        ``solution.control_interval_violations``.
    restarts : Restarts, optional
        Other initial guesses for a problem that was not solved from its guess; ``rt.planning.Restarts(0)`` for none.
        ``solution.history.start`` names the one that led to the solution.
    smoothing : float, optional
        A duration T that is minimised counts as the integral of 1 + smoothing * m in the program of the solver. m is
        the mean square of torques and accelerations relative to their limits, and of what alternates in torques with
        the mesh. Of motions that take the same time it selects a smooth one. T exceeds the least by ``smoothing`` times
        the m of that motion at most, mostly far less, and is the objective.
        Limits on expressions, as of a tool's speed or a motor's power, add accelerations relative to those they allow.
        Where torques against dry friction count, accelerations cost a little too: slow joints would move in bursts, of
        which no drive and no mesh is fast enough. Against much friction that raises an effort by up to 3 percent.
    goals : Goals, optional
        Bounds on the errors between the points: ``rt.solution.Goals()``. The mesh is refined, starting from ``mesh``,
        until all hold. ``solution.proof`` holds the measured errors. With a mesh alone nothing is proved. If the guess
        is a proved solution on that mesh, its ``proof.unsettled`` stands for that of the first solution.
    settings : Settings, optional
        ``solution.settings`` of an earlier plan, which decide every setting. With the same problem, guess and
        continuation the plan is repeated bit for bit. Other options replace single settings.
    time_limit : float, optional
        Processor time [s] of the whole plan: building, its compilers, solves on all meshes, restarts and diagnosis.
        The best solution so far is returned. Its status is ``Status.TIME_LIMIT`` unless it is a proved motion. At the
        limit compilers are stopped, and functions that are not compiled yet are interpreted. Derivatives of shooting
        that would take longer than the time that is left are not begun. Building one program is not interrupted
        otherwise. Before the first iteration, the guess is the solution that is returned.
    memory_limit : float, optional
        Resident memory of the whole process [MB]. A mesh whose blocks alone would exceed it is refused before it is
        built. Otherwise the memory is read between solves, at each iteration and before derivatives of shooting, and
        the plan ends with ``Status.MEMORY_LIMIT``. The memory of one factorisation between two readings is not bounded.
    check : bool
        Raise an error where no solution was found; otherwise return the last iterate with its status.
    progress : bool, optional
        Show iterations; by default only on a terminal.
    watch : bool or LiveWindow
        Show the iterate on its way to the solution, with its residuals, on a page of this machine's browser. A thread
        serves it until the plan ends; the address is printed. A window of your own has methods ``open(page)``,
        ``send(event)`` and ``close()``.
    keep_program : bool
        Keep the program of the solver in the solution, which takes some 20 MB. Plans that start from the solution, with
        other numbers on the same mesh, use it again. Without it they build it again in some 0.02 s to 0.5 s.

    Returns
    -------
    Solution

    Raises
    ------
    NoSolutionFound
        With ``check``, if the status is not solved. ``error.solution`` is the last iterate.
    KeyboardInterrupt
        With ``check``, at Ctrl-C. ``error.solution`` is the best motion or the last iterate. Before the first iterate
        it has no solution, and is raised without ``check`` as well.
    InputError
        An option has another type, or the problem cannot be posed.
    OutOfMemory
        The operating system gave no more memory; it is a ``MemoryError`` too.

    Notes
    -----
    Settings that are left open. The first rule of a setting applies whose conditions, between commas, hold together.
    All robots are *fully actuated* where each joint has a motor, and *arms* if their roots are fixed too. *Friction* is
    dry, and matters for the objective. A cost is *kinked* where absolute values matter. Rates are *free* without limits
    of jerk or torque rate. A program has *stages* where these have few variables.

    ===============  ========================================  =====================================================
    setting          where                                     choice
    ===============  ========================================  =====================================================
    goals            no mesh, no tolerance                     Goals()
    mesh             a path                                    MeshesOnPaths()
                     goals, arms, friction, free rates         Mesh of 16 intervals, RadauIIA()
                     goals, fully actuated, a kinked cost      MeshesOfLines()
                     goals, fully actuated                     MeshOfShares()
                     goals, contacts                           ProportionalMeshes()
                     goals                                     Mesh of 30 intervals, HermiteSimpson()
                     free rates                                Mesh of 20 intervals, RadauIIA()
                     otherwise                                 Mesh of 20 intervals, HermiteSimpson()
    solver           Compiled(), shooting or moving knots      Ipopt()
                     goals, fully actuated, a kinked cost      InteriorPoint(tolerance=1e-06, initial_barrier=0.001)
                     a kinked cost                             Ipopt()
                     goals                                     InteriorPoint(tolerance=1e-06)
                     otherwise                                 InteriorPoint()
    engine           otherwise                                 Native()
    interval_limits  goals                                     BernsteinBounds(controls=True, positions=True)
                     tolerance, robots, stages, free duration  BernsteinBounds(controls=True)
                     tolerance, stages or systems              BernsteinBounds(controls=True, states=False)
                     robots, stages                            BernsteinBounds()
                     otherwise                                 ConstraintGeneration()
    refinement       goals, arms, friction                     Equidistribute(second=3.0, slope=0.3)
                     goals, fully actuated                     RefinementOfShares()
                     goals                                     RefinementOfStates()
                     tolerance                                 SplitOrRaise()
    restarts         contacts                                  Restarts(count=0)
                     joints without a motor                    Restarts(count=12, seeds=(0, 1, 2, 3, 4, 5, 6, 7, 8))
                     otherwise                                 Restarts()
    smoothing        goals                                     0.005
                     otherwise                                 0.0
    ===============  ========================================  =====================================================
    """
    if isinstance(problem, Phase):
        problem = Problem([problem])
    given: object = problem
    if not isinstance(given, Problem):
        several = isinstance(given, list | tuple)
        advice = (
            " rt.sweep plans each of several; rt.Problem(phases, links) makes one motion of them." if several else ""
        )
        if isinstance(given, str | os.PathLike):
            advice = f" rt.load_problem({os.fspath(given)!r}).plan() plans a problem file."
        if isinstance(given, Robot):
            advice = " A motion of it is rt.Phase(robot, duration, start=rt.State(...), end=rt.State(...))."
        raise InputError(f"rt.plan takes an rt.Problem or an rt.Phase; got {type(given).__name__}.{advice}")
    if not isinstance(guess, Solution):
        guess = as_guess(guess)
    given = {
        "tolerance": tolerance,
        "goals": goals,
        "mesh": mesh,
        "solver": solver,
        "engine": engine,
        "interval_limits": interval_limits,
        "refinement": refinement,
        "restarts": restarts,
        "smoothing": smoothing,
    }
    settings = resolve(problem, given, settings)
    if time_limit is not None:
        above_zero("time_limit", time_limit, "s")
    if memory_limit is not None:
        above_zero("memory_limit", memory_limit, "MB")
    warn_of_doubtful(problem, settings)
    find = with_candidates(_method(settings)) if has_candidates(problem) else _method(settings)
    records: tuple[ContinuationRecord, ...] = ()
    with noted() as pressed, shortage_named(), watching(settings.solver, progress) as terminal, ExitStack() as stack:
        live = None
        if watch is not False:
            from robotraj.planning.live.live_plan import live_plan

            live = stack.enter_context(live_plan(problem, watch, terminal))
        shown = live or terminal
        given_limits = time_limit is not None or memory_limit is not None
        show = PlanLimits(time_limit or np.inf, memory_limit or np.inf, shown) if given_limits else shown
        stack.enter_context(limited(show if isinstance(show, PlanLimits) else None))
        if continuation:
            from robotraj.planning.continuation import run_steps

            guess, records, interrupted = run_steps(problem, continuation, guess, settings, show)
        else:
            interrupted = None
        if isinstance(show, PlanLimits):
            show.begin()
        try:
            unheld = unheld_ends(problem)
            if unheld:
                # Before the solve: a payload that is too heavy is often a slip of the pen.
                warn(f"The motors cannot hold an end of the motion at rest: {unheld[0]}.")
            careful = _careful(settings) if unheld else settings
            solution = interrupted or find(problem, guess, careful, show)
            if not solution.success:
                from robotraj.fixed_mesh.coarse import CoarseSolves
                from robotraj.fixed_mesh.diagnosis.explain import explained

                # Without the time to explain a failure it is returned as it is.
                with suppress(LimitReached):
                    solution = explained(solution, CoarseSolves(settings, show))
        except KeyboardInterrupt:
            from robotraj.planning.continuation import last_solution

            found = last_solution(records, guess)
            if found is None:
                raise
            solution = found
        if isinstance(show, PlanLimits):
            solution = show.noted(solution)
        if pressed():
            solution = replace(solution, status=Status.INTERRUPTED)
        if live is not None:
            live.end(solution)
    solution = replace(solution, continuation=records, settings=settings)
    if not keep_program:
        solution = released(solution)
    if check and solution.status is Status.INTERRUPTED:
        raise PlanInterrupted("Ctrl-C ended the plan; this error's `solution` is the best motion so far.", solution)
    if check and not solution.success:
        names = " and ".join(repr(phase.name) for phase in problem.phases)
        verb = "was" if len(problem.phases) == 1 else "were"
        raise NoSolutionFound(f"{names} {verb} not solved: {solution.cause}\n{solution}", solution)
    return solution


def _method(settings: Settings) -> Callable[..., Solution]:
    """Return the function that plans by these settings. A process imports only the one that it needs.

    On a given mesh, and to a tolerance, solves with softer friction come first (``from_softer``); the loop of ``prove``
    has its own.
    """
    if settings.goals is not None:
        from robotraj.planning.proving.prove import prove

        return prove
    from robotraj.planning.proving.softer_guess import from_softer

    if settings.tolerance is not None:
        from robotraj.planning.loop.run import run

        return from_softer(run)
    return from_softer(solve)


def _careful(settings: Settings) -> Settings:
    """Return settings whose solver stops early, for ends that the motors cannot hold; a given solver is kept."""
    if settings.reasons.get("solver") == GIVEN:
        return settings
    return replace(settings, solver=settings.solver.with_early_stop())
