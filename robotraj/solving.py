"""One solve on one mesh: transcribe, solve, evaluate every row again."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from robotraj.guess import Guess, as_guess
from robotraj.problem import Problem
from robotraj.schemes import Mesh
from robotraj.solution import PhaseSolution, Solution
from robotraj.solvers import Multipliers, Progress, Solver
from robotraj.solvers.base import Outcome
from robotraj.status import Status
from robotraj.transcription import Nlp, transcribe
from robotraj.transcription.extract import extract
from robotraj.violations import violations

ROW_TOLERANCE = 1e-6
"""Largest violation of a scaled row or bound that counts as held, when rows are evaluated outside the solver."""


def solve(
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    guess: Guess | Solution | None,
    solver: Solver,
    progress: Progress | None = None,
) -> Solution:
    """Transcribe a problem on a mesh, solve it and check the answer outside the solver."""
    began = time.perf_counter()
    nlp = transcribe(problem, mesh, as_guess(guess))
    _ = nlp.functions
    built = time.perf_counter() - began
    return _conclude(nlp, solver.solve(nlp, progress, _multipliers(guess, nlp)), built)


def _conclude(nlp: Nlp, outcome: Outcome, built: float) -> Solution:
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
