"""Simulation of a plan in equal steps of each interval, with the plan sampled for all of them at once.

Every interval is passed in n steps of the explicit Runge-Kutta method DOP853, whose own estimate of its error chooses
n. As the stages of all steps are known beforehand, the plan is evaluated for all of them in one call, which is where
a simulation that asks at every stage spends most of its time. Intervals that are stiff are left to LSODA.
Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.10.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import DOP853

from robotraj.witness.protocols import Array
from robotraj.witness.simulation.integration import Motion, Stopped, stiff_interval

STAGES = DOP853.n_stages
NODES, MATRIX, WEIGHTS = DOP853.C[:STAGES], DOP853.A[:STAGES, :STAGES], DOP853.B
THIRD, FIFTH = DOP853.E3, DOP853.E5

INTERPOLATED = 16
"""Points of a stiff span at which the plan is evaluated; between them it is interpolated, exactly to degree 15."""

MOST_STEPS = 32
"""Steps of one interval above which it counts as stiff."""

INSIDE = 1e-9
"""How far from its ends, as a part of its length, an interval is sampled: controls may jump at knots."""


class Driven(Protocol):
    """A motion under the planned controls."""

    def given(self, times: Array) -> Array:
        """Give what the plan prescribes at times (m,): one row each, as ``rate`` takes it."""
        ...

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Rate (n,) of a state."""
        ...


class Span(NamedTuple):
    """A part of one interval of a phase, from begin to end [s]."""

    begin: float
    end: float
    interval: int


def spans_of(knots: Array) -> list[Span]:
    """Intervals of a phase that have a length."""
    pairs = zip(knots[:-1], knots[1:], strict=True)
    return [Span(float(begin), float(end), k) for k, (begin, end) in enumerate(pairs) if end > begin]


Settle = Callable[[Array], Array]


def stage_times(span: Span, steps: int) -> Array:
    """Give the times (12 n + 1,) at which n steps of DOP853 evaluate the rate."""
    length = (span.end - span.begin) / steps
    times = (span.begin + length * (np.arange(steps)[:, None] + NODES)).ravel()
    margin = INSIDE * (span.end - span.begin)
    return np.clip(np.append(times, span.end), span.begin + margin, span.end - margin)


def sampled(driven: Driven, spans: Sequence[Span], steps: Sequence[int]) -> list[Array]:
    """Evaluate the plan for the stages of several spans in one call."""
    times = [stage_times(span, count) for span, count in zip(spans, steps, strict=True)]
    given = driven.given(np.concatenate(times))
    ends = np.cumsum([len(part) for part in times])
    return [given[end - len(part) : end] for end, part in zip(ends, times, strict=True)]


class Passed(NamedTuple):
    """A span passed in equal steps: states (n + 1, k) at their ends, and the largest error relative to tolerance."""

    states: Array
    error: float


def steps_through(driven: Driven, x: Array, span: Span, given: Array, rtol: float, atol: float) -> Passed:
    """Pass a span in (len(given) - 1) / 12 steps; given up as soon as the error is far too large."""
    steps = (len(given) - 1) // STAGES
    length = (span.end - span.begin) / steps
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
    """Count the steps that bring the error, of order 8, below the tolerance."""
    factor = 4.0 if not np.isfinite(error) else min(4.0, max(1.25, 1.15 * error**0.125))
    return int(np.ceil(steps * factor))


def fewer_steps(steps: int, error: float) -> int:
    """Count the steps that would have been enough."""
    return max(1, int(np.ceil(steps * min(1.0, 1.15 * error**0.125))))


def march(
    driven: Driven,
    x0: Array,
    spans: Sequence[Span],
    *,
    rtol: float,
    atol: float,
    settle: Settle | None = None,
    clock: Callable[[], None] = lambda: None,
) -> Motion:
    """Simulate through spans that follow each other.

    Parameters
    ----------
    x0 : ndarray (n,)
    rtol, atol : float
        Tolerances of each step.
    settle : callable, optional
        ``settle(x)`` gives the state to go on from at the end of every span.
    clock : callable, optional
        Called before every span; it raises when time is up.
    """
    x, steps, stiff = np.array(x0, dtype=float), 1, None
    times, states, intervals = [np.array([spans[0].begin])], [x[None, :]], [np.array([spans[0].interval])]
    prepared = sampled(driven, spans, [1] * len(spans))
    failure, stopped = None, spans[0].begin
    for span, given in zip(spans, prepared, strict=True):
        clock()
        try:
            found, steps = pass_span(driven, x, span, steps, given, rtol, atol)
        except Stopped as stop:
            failure, stopped = stop.reason, stop.time
            break
        if steps > MOST_STEPS and stiff is None:
            stiff = span.begin
        x = found[-1] if settle is None else settle(found[-1])
        states.append(np.vstack([found[1:-1], x]))
        times.append(np.linspace(span.begin, span.end, len(found))[1:])
        intervals.append(np.full(len(found) - 1, span.interval))
        stopped = span.end
    return Motion(np.concatenate(times), np.vstack(states), np.concatenate(intervals), failure, stopped, stiff)


def pass_span(
    driven: Driven, x: Array, span: Span, steps: int, given: Array, rtol: float, atol: float
) -> tuple[Array, int]:
    """Pass one span, by LSODA where it is stiff.

    Parameters
    ----------
    steps : int
        How many to try first; above ``MOST_STEPS`` the motion is known to be stiff.
    given : sequence
        The plan for a single step.

    Returns
    -------
    states : ndarray (m, n)
        At equal times from the begin to the end of the span.
    steps : int
        How many to begin the next span with.

    Raises
    ------
    Stopped
        The motion diverges.
    """
    while steps <= MOST_STEPS:
        plan = given if steps == 1 else sampled(driven, [span], [steps])[0]
        found = steps_through(driven, x, span, plan, rtol, atol)
        if found.error <= 1.0:
            return found.states, fewer_steps(steps, found.error)
        steps = more_steps(steps, found.error)

    margin = INSIDE * (span.end - span.begin)
    sites, sides = _interpolation()
    times = span.begin + margin + (span.end - span.begin - 2.0 * margin) * sites
    rows = driven.given(times)

    def rates(t: float, state: Array, _: int) -> Array:
        # Asked for one time after the other, the plan itself would take most of the time.
        gaps = t - times
        nearest = int(np.argmin(np.abs(gaps)))
        if gaps[nearest] == 0.0:
            return driven.rate(t, state, rows[nearest])
        weights = sides / gaps
        return driven.rate(t, state, weights @ rows / weights.sum())

    ends = np.array([span.begin, span.end])
    _, _, after, failure = stiff_interval(rates, x, ends, span.interval, rtol, atol)
    if failure is not None:
        raise Stopped(span.begin, failure)
    return np.vstack([x, after]), steps


@lru_cache(maxsize=1)
def _interpolation() -> tuple[Array, Array]:
    """Chebyshev-Lobatto points in [0, 1] and their barycentric weights, for what a plan gives within a span.

    Source: Berrut and Trefethen, Barycentric Lagrange interpolation, SIAM Review 46 (2004).
    """
    sites = 0.5 * (1.0 + chebyshev.chebpts2(INTERPOLATED))
    sides = np.array([(-1.0) ** i for i in range(INTERPOLATED)])
    sides[[0, -1]] *= 0.5
    return sites, sides
