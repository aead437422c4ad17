"""Whether two solutions are the same local optimum."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution

SAMPLES = 201
"""Number of points of a phase at which two trajectories are compared."""
LEAST_RANGE = 1e-3
"""Smallest range relative to which states are compared [their SI unit]."""


def equal_objectives(a: float, b: float, tolerance: float) -> bool:
    """Whether two objectives differ by at most tolerance (1 + abs(a))."""
    return abs(a - b) <= tolerance * (1.0 + abs(a))


def same_optimum(a: Solution, b: Solution, objective: float, trajectory: float, problem: Problem) -> bool:
    """Whether two solutions agree within the tolerances of their objectives and of their trajectories."""
    if not equal_objectives(a.objective, b.objective, objective):
        return False
    parts = zip(a.phases, b.phases, problem.phases, strict=True)
    return all(_distance(p, q, len(phase.body.states)) <= trajectory for p, q, phase in parts)


def _distance(a: PhaseSolution, b: PhaseSolution, states: int) -> float:
    """Largest difference of a state relative to its range, or of the durations relative to the longer one."""
    x, y = (_sampled(part)[:, :states] for part in (a, b))
    span = np.maximum(np.maximum(np.ptp(x, axis=0), np.ptp(y, axis=0)), LEAST_RANGE)
    longer = max(a.duration, b.duration)
    late = abs(a.duration - b.duration) / longer if longer > 0 else 0.0
    return float(np.max(np.abs(x - y).max(axis=0) / span, initial=late))


def _sampled(part: PhaseSolution) -> NDArray[np.float64]:
    return part.trajectory.x(part.t0 + part.duration * np.linspace(0.0, 1.0, SAMPLES))
