"""The smoothest of motions that take the same time.

Least time leaves a joint free that can wait for others. Its torques may then alternate from point to point. In the
program of the solver a duration therefore counts as

    integral of (1 + epsilon m) dt,    m = mean of (y_i / size_i)^2,

with every control and algebraic variable y_i that is bounded on both sides, and size_i its largest bound. Torques that
do not affect the time are then least squares. A limit on an expression, as on the speed of a tool, adds the mean
square of the joints' accelerations relative to those that it allows (``shared_limits``). With m <= 1 the duration T
satisfies T* <= T <= (1 + epsilon) T*. The objective of a solution is that of the problem, without epsilon.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.transcription.smoothness.shared_limits import acceleration_sizes
from robotraj.transcription.smoothness.sticking import acceleration_weights

SMOOTHING = 5e-3
"""The weight epsilon of a proved plan. The loss is of second order: see benchmarks/smoothness.md."""


def smoothing_weights(phase: Phase, smoothing: float) -> tuple[Array, Array]:
    """Return the weights of the squares of algebraic variables, (nz,), and of controls, (nu,).

    They are 0 on a path, whose timing alone is free.
    """
    if smoothing <= 0.0 or phase.path is not None:
        return np.zeros(len(phase.dae.algebraic)), np.zeros(len(phase.dae.controls))
    of_algebraic, of_controls = _of_duration(phase, smoothing)
    return of_algebraic + smoothing * acceleration_weights(phase), of_controls


def _of_duration(phase: Phase, smoothing: float) -> tuple[Array, Array]:
    """Return the weights beside a duration; 0 where none is minimised, and for variables without a size."""
    weight, dae, sizes = weight_of_duration(phase), phase.dae, []
    for variables in (dae.algebraic, dae.controls):
        lower, upper = phase.rows.limits_of(variables)
        size = np.maximum(np.abs(lower), np.abs(upper))
        sizes.append(np.where(size > 0.0, size, np.inf))
    bounded = sum(int(np.isfinite(size).sum()) for size in sizes)
    if weight <= 0.0 or not bounded:
        return np.zeros(len(dae.algebraic)), np.zeros(len(dae.controls))
    of_algebraic, of_controls = (weight * smoothing / bounded / size**2 for size in sizes)
    of_limits = acceleration_sizes(phase)
    joints = max(int(np.isfinite(of_limits).sum()), 1)
    return of_algebraic + weight * smoothing / joints / of_limits**2, of_controls


def weight_of_duration(phase: Phase) -> float:
    """Return the weight of a duration in the objective of a phase."""
    terms = phase.objective.terms if phase.objective is not None else ()
    return sum(weight for weight, term in terms if isinstance(term, Duration))


def smoothing_rate(phase: Phase, smoothing: float, z: ca.SX, u: ca.SX) -> ca.SX | None:
    """Return epsilon m with the weight of the duration, at symbols of one point; None where nothing is smoothed."""
    squares = [
        float(weight) * symbol[i] ** 2
        for symbol, weights in zip((z, u), smoothing_weights(phase, smoothing), strict=True)
        for i, weight in enumerate(weights)
        if weight
    ]
    return sum(squares[1:], squares[0]) if squares else None
