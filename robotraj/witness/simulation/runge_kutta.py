"""Equal steps of the explicit Runge-Kutta method DOP853, with the plan sampled for all stages in one call.

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.10.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853

from robotraj._util.arrays import Array
from robotraj.witness.simulation.spans import Driven, Span

STAGES = DOP853.n_stages
NODES, MATRIX, WEIGHTS = DOP853.C[:STAGES], DOP853.A[:STAGES, :STAGES], DOP853.B
THIRD, FIFTH = DOP853.E3, DOP853.E5


class Passed(NamedTuple):
    """A span passed in equal steps: states (n + 1, k) at their ends, and the largest error relative to tolerance."""

    states: Array
    error: float


def stage_times(span: Span, steps: int) -> Array:
    """Return the times (12 n + 1,) at which n steps evaluate the rate."""
    length = span.length / steps
    times = (span.begin + length * (np.arange(steps)[:, None] + NODES)).ravel()
    return span.inside(np.append(times, span.end))


def sampled(driven: Driven, spans: Sequence[Span], steps: int) -> list[Array]:
    """Evaluate the plan at the stages of several spans in one call."""
    times = np.array([stage_times(span, steps) for span in spans])
    return list(driven.given(times.ravel()).reshape(*times.shape, -1))


def steps_through(driven: Driven, x: Array, span: Span, given: Array, rtol: float, atol: Array) -> Passed:
    """Pass a span in (len(given) - 1) / 12 steps; stop early where the error is far too large."""
    with np.errstate(all="ignore"):
        # A motion may diverge within a step, whose error is then infinite.
        return _steps_through(driven, x, span, given, rtol, atol)


def _steps_through(driven: Driven, x: Array, span: Span, given: Array, rtol: float, atol: Array) -> Passed:
    steps = (len(given) - 1) // STAGES
    length = span.length / steps
    states = np.empty((steps + 1, len(x)))
    states[0] = x
    slopes = np.empty((STAGES + 1, len(x)))
    slopes[0] = driven.rate(span.begin, x, given[0])
    worst = 0.0
    for s in range(steps):
        begin = span.begin + s * length
        for i in range(1, STAGES):
            inner = x + length * (MATRIX[i, :i] @ slopes[:i])
            slopes[i] = driven.rate(begin + NODES[i] * length, inner, given[s * STAGES + i])
        after = x + length * (WEIGHTS @ slopes[:STAGES])
        slopes[STAGES] = driven.rate(begin + length, after, given[(s + 1) * STAGES])
        scale = atol + rtol * np.maximum(np.abs(x), np.abs(after))
        fifth, third = (float(np.sum((part @ slopes / scale) ** 2)) for part in (FIFTH, THIRD))
        bound = fifth + 0.01 * third
        error = 0.0 if bound == 0.0 else abs(length) * fifth / np.sqrt(bound * len(x))
        worst = max(worst, error) if np.isfinite(error) else np.inf
        if worst > 1e6:
            return Passed(states[: s + 1], worst)
        states[s + 1] = x = after
        slopes[0] = slopes[STAGES]
    return Passed(states, worst)


def more_steps(steps: int, error: float) -> int:
    """Return the number of steps that brings the error, of order 8, below the tolerance."""
    factor = 4.0 if not np.isfinite(error) else min(4.0, max(1.25, 1.15 * error**0.125))
    return int(np.ceil(steps * factor))


def fewer_steps(steps: int, error: float) -> int:
    """Return the number of steps that would have been enough."""
    return max(1, int(np.ceil(steps * min(1.0, 1.15 * error**0.125))))
