"""Steps of a singly diagonally implicit Runge-Kutta method (SDIRK) for stiff motions, of order 4 and L-stable.

Friction and damping of light links make the rates of a robot decay within microseconds. Implicit steps follow the
motion without resolving this decay. Friction changes the Jacobian twentyfold within a step, so that every stage
evaluates its own.
The method integrates the deviation e = x - p(t) from a polynomial p through the planned states. For any p,
e' = f(p(t) + e, t) - p'(t); where the plan is accurate, e and its rate are small.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), section IV.6, table 6.5.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from robotraj._util.arrays import Array
from robotraj.witness.simulation.spans import Driven, Span, Stopped

GAMMA = 0.25
NODES = np.array([0.25, 0.75, 0.55, 0.5, 1.0])
MATRIX = np.array(
    [
        [0.25, 0.0, 0.0, 0.0, 0.0],
        [0.5, 0.25, 0.0, 0.0, 0.0],
        [17 / 50, -1 / 25, 0.25, 0.0, 0.0],
        [371 / 1360, -137 / 2720, 15 / 544, 0.25, 0.0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 0.25],
    ]
)
ERROR = MATRIX[-1] - np.array([59 / 48, -17 / 96, 225 / 32, -85 / 12, 0.0])
"""Difference of the weights and those of the embedded method of order 3."""

POINTS = 12
"""Planned states through which the polynomial p of a span passes: exact to degree 11."""

NEWTON = 0.01
"""Correction, relative to the tolerance, below which Newton's iteration stops."""

MOST_ITERATIONS = 8
"""Newton iterations of a stage, after which a shorter step is tried."""

MOST_STEPS = 1000
"""Largest number of steps of one span, including rejected ones."""


class Stepped(NamedTuple):
    """A span passed in adaptive steps: times (m + 1,) and states (m + 1, n) at their ends, and the next step [s]."""

    times: Array
    states: Array
    step: float


class StatePolynomial:
    """The polynomial p(t) through planned states of a span.

    Parameters
    ----------
    span : Span
    states : ndarray (POINTS, n)
        States at ``StatePolynomial.times(span)``.
    """

    def __init__(self, span: Span, states: Array) -> None:
        self._begin, self._length = span.begin, span.length
        self._series = _FROM_VALUES @ states
        self._slopes = chebyshev.chebder(self._series) * (2.0 / span.length)

    @staticmethod
    def times(span: Span) -> Array:
        """Return the Chebyshev-Lobatto points (POINTS,) of a span [s]."""
        return span.inside(span.begin + span.length * 0.5 * (1.0 + chebyshev.chebpts2(POINTS)))

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return p and p' (m, n) at times (m,)."""
        basis = chebyshev.chebvander(2.0 * (times - self._begin) / self._length - 1.0, POINTS - 1)
        return basis @ self._series, basis[:, :-1] @ self._slopes


_FROM_VALUES = np.linalg.inv(chebyshev.chebvander(chebyshev.chebpts2(POINTS), POINTS - 1))


def references(driven: Driven, spans: Sequence[Span]) -> list[StatePolynomial]:
    """Sample the planned states of several spans in one call."""
    times = np.array([StatePolynomial.times(span) for span in spans])
    intervals = np.repeat([span.interval for span in spans], POINTS)
    states = driven.states(times.ravel(), intervals).reshape(*times.shape, -1)
    return [StatePolynomial(span, values) for span, values in zip(spans, states, strict=True)]


def sampled(driven: Driven, spans: Sequence[Span]) -> list[Array]:
    """Evaluate the plan for one step through each of several spans in one call."""
    times = np.array([span.inside(span.begin + span.length * NODES) for span in spans])
    return list(driven.given(times.ravel()).reshape(*times.shape, -1))


def pass_stiffly(
    driven: Driven,
    x: Array,
    span: Span,
    reference: StatePolynomial,
    given: Array,
    step: float,
    rtol: float,
    atol: Array,
    clock: Callable[[], None] = lambda: None,
) -> Stepped:
    """Pass a span in adaptive steps.

    Parameters
    ----------
    given : ndarray (5, ...)
        The plan for a single step through the span; for shorter steps it is evaluated here.
    step : float
        First step to try [s].
    clock : callable, optional
        Called before every step; it raises where no time is left.

    Raises
    ------
    Stopped
        The motion diverges, or takes more than ``MOST_STEPS`` steps.
    """
    t, times, states = span.begin, [span.begin], [x]
    for _ in range(MOST_STEPS):
        clock()
        wanted, left = step, span.end - t
        last = wanted >= left * (1.0 - 1e-9)
        step = left if last else wanted
        at = span.inside(t + step * NODES)
        plan = given if step == span.length else driven.given(at)
        after, error = take_step(driven, x, t, step, at, plan, reference, rtol, atol)
        proposed = step * float(np.clip(0.9 * (error + 1e-8) ** -0.25, 0.1, 6.0))
        if error <= 1.0:
            t, x = t + step, after
            times.append(t)
            states.append(x)
            if last:
                # The next span does not begin with the length of a short last step.
                return Stepped(np.array(times), np.array(states), max(wanted, proposed))
        step = proposed
        if step < 1e-12 * span.length:
            raise Stopped(t, "the step size fell below round-off: the motion diverges")
    raise Stopped(t, f"more than {MOST_STEPS} steps in one part of an interval: too stiff or divergent")


def take_step(
    driven: Driven,
    x: Array,
    begin: float,
    step: float,
    at: Array,
    plan: Array,
    reference: StatePolynomial,
    rtol: float,
    atol: Array,
) -> tuple[Array, float]:
    """Take one step; return the state at its end and the error relative to the tolerance, infinite where it failed."""
    path, slope = reference.at(np.append(at, begin))
    away = x - path[-1]
    scale = atol + rtol * np.abs(x)
    rates = np.zeros((len(NODES), len(x)))
    inverse: Array = np.eye(len(x))
    with np.errstate(all="ignore"):
        for i, t in enumerate(at.tolist()):
            base = away + step * (MATRIX[i, :i] @ rates[:i])
            system = np.eye(len(x)) - GAMMA * step * driven.jacobian(t, path[i] + base, plan[i])
            if not np.isfinite(system).all():
                return x, np.inf
            try:
                inverse = np.asarray(np.linalg.inv(system), dtype=float)
            except np.linalg.LinAlgError:
                return x, np.inf
            for _ in range(MOST_ITERATIONS):
                state = path[i] + base + GAMMA * step * rates[i]
                correction = inverse @ (driven.rate(t, state, plan[i]) - slope[i] - rates[i])
                rates[i] += correction
                size = GAMMA * step * np.max(np.abs(correction) / scale)
                # Newton's method converges quadratically, so that the next correction is negligible.
                if size < NEWTON:
                    break
            else:
                return x, np.inf
        after = x - path[-1] + step * (MATRIX[-1] @ rates) + path[len(NODES) - 1]
        error = inverse @ (step * (ERROR @ rates))
        relative = float(np.sqrt(np.mean((error / (atol + rtol * np.maximum(np.abs(x), np.abs(after)))) ** 2)))
    return after, relative if np.isfinite(relative) else np.inf
