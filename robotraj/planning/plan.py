"""plan(): from a problem to a checked solution in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError, NoSolutionFound
from robotraj.guess.guess import Guess
from robotraj.native.engines.base import Engine
from robotraj.planning.progress import watching
from robotraj.planning.solve import solve
from robotraj.planning.solver_choice import engine_for, solver_for
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Solver
from robotraj.solvers.ipopt import Ipopt
from robotraj.transcription.interval_limits.methods import BernsteinBounds, ConstraintGeneration
from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from robotraj.planning.continuation import ContinuationStep
    from robotraj.solution.records import ContinuationRecord
    from robotraj.transcription.refinement.strategy import Refinement


def plan(
    problem: Problem | Phase,
    mesh: Mesh | Sequence[Mesh] | None = None,
    guess: Guess | Solution | None = None,
    solver: Solver | None = None,
    *,
    engine: Engine | None = None,
    tolerance: float | None = None,
    refinement: Refinement | None = None,
    continuation: Sequence[ContinuationStep] = (),
    interval_limits: ConstraintGeneration | None = None,
    check: bool = True,
    progress: bool | None = None,
) -> Solution:
    """Transcribe, solve and check.

    Parameters
    ----------
    problem : Problem or Phase
    mesh : Mesh or sequence of Mesh, optional
        One for all phases or one for each; 40 Hermite-Simpson intervals by default. With ``tolerance``, the first
        mesh, of 20 intervals of Radau IIA with 3 points by default.
    guess : Guess or Solution, optional
        A straight line by default; an earlier solution on any mesh and scheme warm starts. Where a plan without
        contacts leads nowhere, it begins elsewhere (``robotraj.planning.restarts``): from longer motions where
        a duration is
        free, unless the guess has a course of its own, and from seeded variations of the default. The message of a
        solution on one mesh says so; with ``tolerance`` it is the last mesh's, which starts from the one before.
    solver : Solver, optional
        By default ``rt.Fatrop()`` for robots with a fixed root, without contacts, design parameters, continuous joints,
        integral constraints or costs with variables of their own, and for an ``rt.System`` that has a control for every
        second state; ``rt.Ipopt()`` for all else and with ``engine=rt.engines.Compiled()``.
    engine : Engine, optional
        Evaluates the point functions: by default ``rt.engines.Native()`` with ``rt.Fatrop()`` and for robots with a
        free-flyer, ``rt.engines.VirtualMachine()`` with ``rt.Ipopt()`` for all else. The former is many times
        faster, the
        numbers are the same to rounding, and neither needs a compiler; ``rt.engines.Compiled()`` keeps
        libraries of C for later
        plans.
    tolerance : float, optional
        Refine the mesh until the relative error between the knots (``refinement.errors_of``) is below this and
        the objective has settled to it. Any scheme; those of low order, shooting with constant controls above all,
        take many intervals to settle. A tolerance that was not reached is said in the status.
    refinement : Refinement, optional
        How meshes are refined; ``rt.refinement.SplitOrRaise()`` (hp) by default, which splits the intervals of
        shooting and
        compressed collocation (h), since they have no order to raise.
    continuation : sequence of ContinuationStep
        Easier problems solved first, each the guess of the next: coarser meshes, fewer constraints, simpler
        objectives. The last stage, the problem itself, is understood.
    interval_limits : ConstraintGeneration, optional
        What holds rows on states and controls between the collocation points:
        ``rt.interval_limits.ConstraintGeneration()`` imposes those on states
        where a solution breaks them and solves again, the default with ``rt.Ipopt()`` and for systems;
        ``rt.interval_limits.BernsteinBounds()`` holds limits of speeds everywhere in one solve, and asks a
        little more than they do, the
        default for robots with ``rt.Fatrop()``; ``rt.interval_limits.BernsteinBounds(controls=True)`` holds
        torques so too, the default for
        these with a tolerance (``states=False`` where durations are fixed), and for systems (``states=False``). What is
        broken nevertheless is told:
        ``solution.interval_violations``, ``solution.control_interval_violations``.
    check : bool
        Raise where no solution was found; else return it with its status.
    progress : bool, optional
        Show iterations; by default only on a terminal.

    Returns
    -------
    Solution

    Raises
    ------
    NoSolutionFound
        With ``check``, when the status is not solved; the error carries the last iterate as ``.solution``.
    """
    if isinstance(problem, Phase):
        problem = Problem([problem])
    if not isinstance(problem, Problem):
        raise InputError(f"rt.plan takes an rt.Problem or an rt.Phase; got {type(problem).__name__}.")
    if mesh is None:
        mesh = Mesh() if tolerance is None else _coarse()
    if not isinstance(mesh, Mesh) and not (isinstance(mesh, Sequence) and all(isinstance(m, Mesh) for m in mesh)):
        raise InputError(f"mesh= must be an rt.Mesh, or one for each phase; got {mesh!r}.")
    for_ipopt = engine is not None and isinstance(engine, Engine) and engine.made_for_ipopt
    solver = solver or (Ipopt() if for_ipopt else solver_for(problem, mesh))
    if not isinstance(solver, Solver):
        raise InputError(f"solver= must be a solver value such as rt.Ipopt(); got {solver!r}.")
    if engine is None:
        engine = engine_for(problem, solver)
    if not isinstance(engine, Engine):
        raise InputError(
            f"engine= must be rt.engines.VirtualMachine(), rt.engines.Native() or rt.engines.Compiled(); got "
            f"{engine!r}."
        )
    if tolerance is not None and not (isinstance(tolerance, float | int | np.number) and 0 < tolerance < 1):
        raise InputError(f"tolerance= is a relative error between 0 and 1, such as 1e-6; got {tolerance!r}.")
    if refinement is not None and tolerance is None:
        raise InputError("refinement= says how meshes are refined until a tolerance holds; give tolerance= as well.")
    if interval_limits is None:
        # Equations of one's own have no motors to spare: on a given mesh a hull asks for more than their limits.
        robots = all(phase.robot is not None for phase in problem.phases)
        interval_limits = solver.default_interval_limits() if robots else ConstraintGeneration()
        if tolerance is not None and isinstance(interval_limits, BernsteinBounds):
            # Torques that switch would bulge to twice their limits between the points of short intervals. What a hull
            # of speeds asks for beyond their limits is more than the tolerance at a fixed duration; at a free one it
            # goes with the mesh, and the meshes are fewer.
            free = any(low < high for low, high in (phase.duration_bounds for phase in problem.phases))
            interval_limits = replace(interval_limits, controls=True, states=free)
        elif tolerance is not None and not robots:
            # So do controls of one's own; what the hull asks for beyond their limits goes with the mesh.
            interval_limits = BernsteinBounds(states=False, controls=True)
    if not isinstance(interval_limits, ConstraintGeneration):
        raise InputError(
            f"interval_limits= must be rt.interval_limits.ConstraintGeneration() or "
            f"rt.interval_limits.BernsteinBounds(); got {interval_limits!r}."
        )
    with watching(solver, progress) as show:
        # What few plans ask for is imported when it is asked for.
        records: tuple[ContinuationRecord, ...] = ()
        interrupted = None
        if continuation:
            from robotraj.planning.continuation import found_by, run_stages

            guess, records, interrupted = run_stages(
                problem, continuation, mesh, guess, solver, show, interval_limits, engine
            )
        try:
            if interrupted is not None:
                solution = interrupted
            elif tolerance is None:
                solution = solve(problem, mesh, guess, solver, show, interval_limits, engine)
            else:
                from robotraj.planning.refine import adapt
                from robotraj.transcription.refinement.orders import SplitOrRaise

                solution = adapt(
                    problem, mesh, guess, solver, show, tolerance, refinement or SplitOrRaise(), engine, interval_limits
                )
        except KeyboardInterrupt:
            found = found_by(records, guess) if continuation else None
            if found is None:
                raise
            solution = found
    solution = replace(solution, continuation=records)
    if check and not solution.success:
        names = " and ".join(repr(phase.name) for phase in problem.phases)
        verb = "was" if len(problem.phases) == 1 else "were"
        raise NoSolutionFound(f"{names} {verb} not solved.\n{solution}", solution)
    return solution


def _coarse() -> Mesh:
    """Mesh that refinement starts from."""
    from robotraj.transcription.schemes.radau import RadauIIA

    return Mesh(20, RadauIIA(3))
