"""plan(): from a problem to a checked solution in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj.adaptive import adapt
from robotraj.engines import Engine, VirtualMachine
from robotraj.errors import InputError, NoSolutionFound
from robotraj.guess import Guess
from robotraj.problem import Phase, Problem
from robotraj.progress import watching
from robotraj.refinement import Refinement, SplitOrRaise
from robotraj.schemes import Mesh, RadauIIA
from robotraj.solution import Solution
from robotraj.solvers import Ipopt, Solver
from robotraj.solving import solve
from robotraj.stages import Stage, run_stages


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
        A straight line by default; an earlier solution on any mesh and scheme warm starts.
    solver : Solver, optional
        ``rt.Ipopt()`` by default.
    engine : Engine, optional
        Evaluates the point functions: ``rt.VirtualMachine()``, which needs no compiler, by default;
        ``rt.Compiled()`` is many times faster and keeps its libraries for later plans.
    tolerance : float, optional
        Refine the mesh until the relative error between the knots (``refinement.interval_errors``) is below this and
        the objective has settled to it. Any scheme; those of low order, shooting with constant controls above all,
        take many intervals to settle. A tolerance that was not reached is said in the status.
    refinement : Refinement, optional
        How meshes are refined; ``rt.SplitOrRaise()`` (hp) by default, which splits the intervals of shooting and
        compressed collocation (h), since they have no order to raise.
    stages : sequence of Stage
        Easier problems solved first, each the guess of the next: coarser meshes, fewer constraints, simpler
        objectives. The last stage, the problem itself, is understood.
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
        mesh = Mesh() if tolerance is None else Mesh(20, RadauIIA(3))
    several = isinstance(mesh, Sequence) and all(isinstance(m, Mesh) for m in mesh)
    if not isinstance(mesh, Mesh) and not several:
        raise InputError(f"mesh= must be an rt.Mesh, or one for each phase; got {mesh!r}.")
    solver = solver or Ipopt()
    if not isinstance(solver, Solver):
        raise InputError(f"solver= must be a solver value such as rt.Ipopt(); got {solver!r}.")
    if engine is None:
        engine = VirtualMachine()
    if not isinstance(engine, Engine):
        raise InputError(f"engine= must be rt.VirtualMachine() or rt.Compiled(); got {engine!r}.")
    if tolerance is not None and not 0 < tolerance < 1:
        raise InputError(f"tolerance= is a relative error between 0 and 1, such as 1e-6; got {tolerance}.")
    with watching(solver, progress) as show:
        guess, records = run_stages(problem, stages, mesh, guess, solver, show, engine)
        if tolerance is None:
            solution = solve(problem, mesh, guess, solver, show, engine=engine)
        else:
            solution = adapt(problem, mesh, guess, solver, show, tolerance, refinement or SplitOrRaise(), engine)
    solution = replace(solution, stages=records)
    if check and not solution.success:
        names = " and ".join(repr(phase.name) for phase in problem.phases)
        verb = "was" if len(problem.phases) == 1 else "were"
        raise NoSolutionFound(f"{names} {verb} not solved.\n{solution}", solution)
    return solution
