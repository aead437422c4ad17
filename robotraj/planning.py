"""plan(): from a problem to a checked solution in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj.engines import Engine
from robotraj.errors import InputError, NoSolutionFound
from robotraj.guess import Guess
from robotraj.phase import Phase
from robotraj.problem import Problem
from robotraj.progress import watching
from robotraj.schemes import Mesh
from robotraj.solution import Solution
from robotraj.solvers import Ipopt, Solver
from robotraj.solvers.choice import engine_for, solver_for
from robotraj.solving import solve
from robotraj.transcription.between import ConvexHull, Exchange

if TYPE_CHECKING:
    from robotraj.records import StageRecord
    from robotraj.refinement import Refinement
    from robotraj.stages import Stage


def plan(
    problem: Problem | Phase,
    mesh: Mesh | Sequence[Mesh] | None = None,
    guess: Guess | Solution | None = None,
    solver: Solver | None = None,
    *,
    engine: Engine | None = None,
    tolerance: float | None = None,
    refinement: Refinement | None = None,
    stages: Sequence[Stage] = (),
    between: Exchange | None = None,
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
        contacts leads nowhere, it begins elsewhere (``robotraj.retries``): from longer motions where a duration is
        free, unless the guess has a course of its own, and from seeded variations of the default. The message of a
        solution on one mesh says so; with ``tolerance`` it is the last mesh's, which starts from the one before.
    solver : Solver, optional
        By default ``rt.Fatrop()`` for robots with a fixed root, without contacts, design parameters, continuous joints,
        integral constraints or costs with variables of their own, and for an ``rt.System`` that has a control for every
        second state; ``rt.Ipopt()`` for all else and with ``engine=rt.Compiled()``.
    engine : Engine, optional
        Evaluates the point functions: by default ``rt.Native()`` with ``rt.Fatrop()`` and for robots with a
        free-flyer, ``rt.VirtualMachine()`` with ``rt.Ipopt()`` for all else. The former is many times faster, the
        numbers are the same to rounding, and neither needs a compiler; ``rt.Compiled()`` keeps libraries of C for later
        plans.
    tolerance : float, optional
        Refine the mesh until the relative error between the knots (``refinement.errors_of``) is below this and
        the objective has settled to it. Any scheme; those of low order, shooting with constant controls above all,
        take many intervals to settle. A tolerance that was not reached is said in the status.
    refinement : Refinement, optional
        How meshes are refined; ``rt.SplitOrRaise()`` (hp) by default, which splits the intervals of shooting and
        compressed collocation (h), since they have no order to raise.
    stages : sequence of Stage
        Easier problems solved first, each the guess of the next: coarser meshes, fewer constraints, simpler
        objectives. The last stage, the problem itself, is understood.
    between : Exchange, optional
        What holds rows on states and controls between the collocation points: ``rt.Exchange()`` imposes those on states
        where a solution breaks them and solves again, the default with ``rt.Ipopt()`` and for systems;
        ``rt.ConvexHull()`` holds limits of speeds everywhere in one solve, and asks a little more than they do, the
        default for robots with ``rt.Fatrop()``; ``rt.ConvexHull(controls=True)`` holds torques so too, the default for
        these with a tolerance (``states=False`` where durations are fixed), and for systems (``states=False``). What is
        broken nevertheless is told:
        ``solution.between``, ``solution.controls_between``.
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
        raise InputError(f"engine= must be rt.VirtualMachine(), rt.Native() or rt.Compiled(); got {engine!r}.")
    if tolerance is not None and not (isinstance(tolerance, float | int | np.number) and 0 < tolerance < 1):
        raise InputError(f"tolerance= is a relative error between 0 and 1, such as 1e-6; got {tolerance!r}.")
    if refinement is not None and tolerance is None:
        raise InputError("refinement= says how meshes are refined until a tolerance holds; give tolerance= as well.")
    if between is None:
        # Equations of one's own have no motors to spare: on a given mesh a hull asks for more than their limits.
        robots = all(phase.robot is not None for phase in problem.phases)
        between = solver.default_between() if robots else Exchange()
        if tolerance is not None and isinstance(between, ConvexHull):
            # Torques that switch would bulge to twice their limits between the points of short intervals. What a hull
            # of speeds asks for beyond their limits is more than the tolerance at a fixed duration; at a free one it
            # goes with the mesh, and the meshes are fewer.
            free = any(low < high for low, high in (phase.duration_bounds for phase in problem.phases))
            between = replace(between, controls=True, states=free)
        elif tolerance is not None and not robots:
            # So do controls of one's own; what the hull asks for beyond their limits goes with the mesh.
            between = ConvexHull(states=False, controls=True)
    if not isinstance(between, Exchange):
        raise InputError(f"between= must be rt.Exchange() or rt.ConvexHull(); got {between!r}.")
    with watching(solver, progress) as show:
        # What few plans ask for is imported when it is asked for.
        records: tuple[StageRecord, ...] = ()
        interrupted = None
        if stages:
            from robotraj.stages import found_by, run_stages

            guess, records, interrupted = run_stages(problem, stages, mesh, guess, solver, show, between, engine)
        try:
            if interrupted is not None:
                solution = interrupted
            elif tolerance is None:
                solution = solve(problem, mesh, guess, solver, show, between, engine)
            else:
                from robotraj.adaptive import adapt
                from robotraj.refinement import SplitOrRaise

                solution = adapt(
                    problem, mesh, guess, solver, show, tolerance, refinement or SplitOrRaise(), engine, between
                )
        except KeyboardInterrupt:
            found = found_by(records, guess) if stages else None
            if found is None:
                raise
            solution = found
    solution = replace(solution, stages=records)
    if check and not solution.success:
        names = " and ".join(repr(phase.name) for phase in problem.phases)
        verb = "was" if len(problem.phases) == 1 else "were"
        raise NoSolutionFound(f"{names} {verb} not solved.\n{solution}", solution)
    return solution


def _coarse() -> Mesh:
    """Mesh that refinement starts from."""
    from robotraj.schemes import RadauIIA

    return Mesh(20, RadauIIA(3))
