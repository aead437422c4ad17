"""Simulation of a plan span by span: explicit steps where the motion is smooth, implicit steps where it is stiff."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.witness.protocols import Settle
from robotraj.witness.simulation import runge_kutta, sdirk
from robotraj.witness.simulation.spans import Driven, Motion, Span, Stopped

STABLE = 20.0
"""Largest |eigenvalue| of the Jacobian times length of a span that counts as smooth; DOP853 is stable up to 6."""

LOOKS = 8
"""Spans at whose beginning the Jacobian is evaluated, to find out whether a phase is stiff."""

MOST_STEPS = 32
"""Explicit steps of one span above which it counts as stiff."""

STIFF_TOLERANCE = 1e-6
"""Smallest relative and absolute tolerance of stiff motions, whose local errors decay."""


class Stepper:
    """Passes through the spans of one phase.

    Parameters
    ----------
    driven : Driven
    spans : sequence of Span
        All that will be passed through, in any order; the plan is sampled for all of them in one call.
    sizes : ndarray (n,)
        Sizes of the states.
    rtol, atol : float
        Tolerances of each step: its error is at most rtol |x| + atol times the size of the state.

    Attributes
    ----------
    stiff : float or None
        Begin [s] of the first span that was passed by implicit steps.
    """

    def __init__(
        self,
        driven: Driven,
        spans: Sequence[Span],
        sizes: Array,
        rtol: float,
        atol: float,
        clock: Callable[[], None] = lambda: None,
    ) -> None:
        self._driven, self._sizes, self._rtol, self._atol, self._clock = driven, sizes, rtol, atol, clock
        self._steps = 1
        self._step = np.inf
        self.stiff: float | None = None
        self._all_stiff = is_stiff(driven, spans)
        if self._all_stiff:
            self._given = dict(zip(spans, sdirk.sampled(driven, spans), strict=True))
            self._references = dict(zip(spans, sdirk.references(driven, spans), strict=True))
        else:
            self._given = dict(zip(spans, runge_kutta.sampled(driven, spans, 1), strict=True))

    def through(self, x: Array, span: Span) -> tuple[Array, Array]:
        """Pass a span from state x; return times (m,) and states (m, n) from its begin to its end.

        Raises
        ------
        Stopped
            The motion diverges.
        """
        if not self._all_stiff:
            found = self._explicitly(x, span)
            if found is not None:
                return found
        return self._stiffly(x, span)

    def _explicitly(self, x: Array, span: Span) -> tuple[Array, Array] | None:
        """Pass a span in equal steps, as many as their error needs; None where they are too many."""
        driven, steps = self._driven, self._steps
        while steps <= MOST_STEPS:
            self._clock()
            plan = self._given[span] if steps == 1 else runge_kutta.sampled(driven, [span], steps)[0]
            found = runge_kutta.steps_through(driven, x, span, plan, self._rtol, self._atol * self._sizes)
            if found.error <= 1.0:
                self._steps = runge_kutta.fewer_steps(steps, found.error)
                return np.linspace(span.begin, span.end, len(found.states)), found.states
            steps = runge_kutta.more_steps(steps, found.error)
        self._steps = MOST_STEPS
        return None

    def _stiffly(self, x: Array, span: Span) -> tuple[Array, Array]:
        driven = self._driven
        if self.stiff is None:
            self.stiff = span.begin
        if self._all_stiff:
            given, reference = self._given[span], self._references[span]
        else:
            given, reference = sdirk.sampled(driven, [span])[0], sdirk.references(driven, [span])[0]
        rtol, atol = max(self._rtol, STIFF_TOLERANCE), max(self._atol, STIFF_TOLERANCE)
        step = min(self._step, span.length)
        found = sdirk.pass_stiffly(driven, x, span, reference, given, step, rtol, atol * self._sizes, self._clock)
        self._step = found.step
        return found.times, found.states


def is_stiff(driven: Driven, spans: Sequence[Span]) -> bool:
    """Return whether stability, not accuracy, would choose the steps of DOP853."""
    chosen = [spans[i] for i in np.unique(np.linspace(0, len(spans) - 1, LOOKS).astype(int))]
    times = np.array([span.begin for span in chosen])
    inside = np.array([span.inside(np.array([span.begin]))[0] for span in chosen])
    states, given = driven.states(times, np.array([span.interval for span in chosen])), driven.given(inside)
    for span, x, plan in zip(chosen, states, given, strict=True):
        with np.errstate(all="ignore"):
            matrix = driven.jacobian(span.begin, x, plan)
        if not np.isfinite(matrix).all():
            continue
        if np.max(np.abs(np.linalg.eigvals(matrix)), initial=0.0) * span.length > STABLE:
            return True
    return False


def march(
    driven: Driven,
    x0: Array,
    spans: Sequence[Span],
    sizes: Array,
    *,
    rtol: float,
    atol: float,
    settle: Settle | None = None,
    ended: Callable[[Array, Span], str | None] | None = None,
    clock: Callable[[], None] = lambda: None,
) -> Motion:
    """Simulate through consecutive spans.

    Parameters
    ----------
    x0 : ndarray (n,)
    sizes : ndarray (n,)
        Sizes of the states.
    rtol, atol : float
        Tolerances of each step, see ``Stepper``.
    settle : callable, optional
        ``settle(x)`` returns the state from which to continue at the end of every span.
    ended : callable, optional
        ``ended(x, span)`` returns why the simulation ends with the state at the end of a span; None continues it.
    clock : callable, optional
        Called before every span and step; it raises when the time limit is reached.
    """
    x, stepper = np.array(x0, dtype=float), Stepper(driven, spans, sizes, rtol, atol, clock)
    times, states, intervals = [np.array([spans[0].begin])], [x[None, :]], [np.array([spans[0].interval])]
    failure, stopped = None, spans[0].begin
    for span in spans:
        clock()
        try:
            ends, found = stepper.through(x, span)
        except Stopped as stop:
            failure, stopped = stop.reason, stop.time
            break
        x = found[-1] if settle is None else settle(found[-1])
        states.append(np.vstack([found[1:-1], x]))
        times.append(ends[1:])
        intervals.append(np.full(len(found) - 1, span.interval))
        stopped = span.end
        if ended is not None and (failure := ended(x, span)) is not None:
            break
    return Motion(np.concatenate(times), np.vstack(states), np.concatenate(intervals), failure, stopped, stepper.stiff)
