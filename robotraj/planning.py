"""plan(): from a problem to a checked solution in one call."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from robotraj.errors import InputError, NoSolutionFound
from robotraj.guess import Guess, as_guess
from robotraj.problem import Phase, Problem
from robotraj.progress import watching
from robotraj.schemes import Mesh
from robotraj.solution import PhaseSolution, Solution
from robotraj.solvers import Ipopt, Multipliers, Solver
from robotraj.solvers.base import Outcome
from robotraj.status import Status
from robotraj.transcription import Nlp, transcribe
from robotraj.transcription.extract import extract
from robotraj.violations import violations

ROW_TOLERANCE = 1e-6
"""Largest violation of a scaled row or bound that counts as held, when rows are evaluated outside the solver."""


def plan(
    problem: Problem | Phase,
    mesh: Mesh | Sequence[Mesh] | None = None,
    guess: Guess | Solution | None = None,
    solver: Solver | None = None,
    *,
    check: bool = True,
    progress: bool | None = None,
) -> Solution:
    """Transcribe, solve and check.

    Parameters
    ----------
    problem : Problem or Phase
    mesh : Mesh or sequence of Mesh, optional
        One for all phases or one for each; 40 Hermite-Simpson intervals by default.
    guess : Guess or Solution, optional
        A straight line by default; an earlier solution on any mesh and scheme warm starts.
    solver : Solver, optional
        ``rt.Ipopt()`` by default.
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
    mesh = Mesh() if mesh is None else mesh
    if not isinstance(mesh, Mesh) and not all(isinstance(m, Mesh) for m in mesh):
        raise InputError("mesh= must be an rt.Mesh, or one for each phase.")
    solver = solver or Ipopt()
    if not isinstance(solver, Solver):
        raise InputError(f"solver= must be a solver value such as rt.Ipopt(); got {solver!r}.")
    began = time.perf_counter()
    start = as_guess(guess)
    nlp = transcribe(problem, mesh, start)
    _ = nlp.functions
    built = time.perf_counter() - began
    with watching(solver, progress) as show:
        outcome = solver.solve(nlp, show, _multipliers(guess, nlp))
    solution = conclude(nlp, outcome, built)
    if check and not solution.success:
        raise NoSolutionFound(f"{problem.phases[0].name!r} was not solved.\n{solution}", solution)
    return solution


def conclude(nlp: Nlp, outcome: Outcome, built: float) -> Solution:
    """Evaluate every row again outside the solver and wrap up what it found."""
    broken = violations(nlp, outcome.w, ROW_TOLERANCE)
    status = outcome.status
    if status is Status.SOLVED and broken:
        status = Status.ROWS_VIOLATED
    trajectories = extract(nlp, outcome.w)
    phases = tuple(
        PhaseSolution(phase, layout.mesh, trajectory)
        for phase, layout, trajectory in zip(nlp.problem.phases, nlp.layouts, trajectories, strict=True)
    )
    return Solution(
        nlp.problem,
        phases,
        status,
        outcome.message,
        nlp.objective(outcome.w),
        outcome.iterations,
        {"build": built, **{k: v for k, v in outcome.times.items() if k != "evaluate"}},
        broken,
        outcome.multipliers,
    )


def _multipliers(guess: Any, nlp: Nlp) -> Multipliers | None:
    """Multipliers of an earlier solution, where they belong to an NLP of the same size."""
    if not isinstance(guess, Solution) or guess.multipliers is None or not guess.success:
        return None
    known = guess.multipliers
    same = known.rows.shape == (len(nlp.rows),) and known.bounds.shape == (len(nlp.variables),)
    return known if same and np.all(np.isfinite(known.rows)) else None
