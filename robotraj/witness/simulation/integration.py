"""Initial value problems under any torque, whose right-hand sides are smooth only between knots.

DOP853 is restarted at every knot, since its error estimate holds for smooth right-hand sides. Friction of light links
makes robots stiff, and stability then shortens explicit steps. From the first interval with too many of them, LSODA
integrates, which uses backward differences for stiff motions. Plans are simulated by ``steps.py`` instead.
Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.10; Petzold, Automatic
selection of methods for solving stiff and nonstiff systems of ordinary differential equations, SIAM J. Sci. Stat.
Comput. 4 (1983).
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable

import numpy as np
import scipy

from robotraj._util.arrays import Array
from robotraj.witness.protocols import Settle
from robotraj.witness.simulation.spans import Motion, Stopped

Rates = Callable[[float, Array, int], Array]

MOST_EVALUATIONS = 200_000
"""Largest number of evaluations of the rates in one interval."""

MOST_EXPLICIT = 2_000
"""Evaluations by DOP853 in one interval above which LSODA integrates; a smooth motion takes about 50."""

LSODA_TOLERANCE = 0.1
"""Ratio of the tolerances of LSODA and DOP853 at which their errors over an interval are equal."""

FINEST = 1e-13
"""Smallest relative tolerance that LSODA accepts."""

_LSODA = threading.Lock()
"""ODEPACK has one state for all threads."""


class TooMany(Stopped):
    """The integration takes more than the allowed evaluations."""


def integrate(
    rates: Rates,
    x0: Array,
    knots: Array,
    *,
    rtol: float = 1e-10,
    atol: float = 1e-12,
    samples_per_interval: int = 20,
    settle: Settle | None = None,
) -> Motion:
    """Integrate xdot = rates(t, x, k) over the intervals k between knots, by DOP853 or, where it is stiff, LSODA.

    A state or rate that is not finite, a step below round-off and more than ``MOST_EVALUATIONS`` evaluations
    in one interval end the motion early; ``failure`` reports it, no error is raised.

    Parameters
    ----------
    rates : callable
        ``rates(t, x, k)`` returns (n,), smooth in interval k.
    x0 : ndarray (n,)
    knots : ndarray (K + 1,)
        Ascending times [s]; intervals of no length are skipped.
    rtol, atol : float
        Tolerances of each step.
    samples_per_interval : int
        Samples of each interval.
    settle : callable, optional
        ``settle(x)`` returns the state (n,) from which to continue at each knot.
    """
    times: list[Array] = []
    states: list[Array] = []
    intervals: list[int] = []
    x = np.array(x0, dtype=float)
    failure, stopped, stiff = None, float(knots[0]), None
    for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        if end <= begin:
            continue
        sampled = np.linspace(begin, end, samples_per_interval + 1)
        try:
            if stiff is None:
                try:
                    kept, x_kept, x, failure = _interval(rates, x, sampled, k, "DOP853", rtol, atol, MOST_EXPLICIT)
                except TooMany:
                    stiff = float(begin)
            if stiff is not None:
                kept, x_kept, x, failure = stiff_interval(rates, x, sampled, k, rtol, atol)
        except Stopped as stop:
            failure, stopped = stop.reason, stop.time
            break
        if settle is not None and failure is None:
            x = settle(x)
        times.append(kept)
        states.append(x_kept)
        intervals += [k] * len(kept)
        stopped = float(kept[-1]) if failure else float(end)
        if failure:
            break
    if failure is None:
        times.append(np.array([stopped]))
        states.append(x[None, :])
        intervals.append(max(len(knots) - 2, 0))
    flat_times = np.concatenate(times) if times else np.array([stopped])
    flat_states = np.concatenate(states) if states else x[None, :]
    return Motion(flat_times, flat_states, np.array(intervals or [0]), failure, stopped, stiff)


def stiff_interval(
    rates: Rates, x: Array, sampled: Array, k: int, rtol: float, atol: float
) -> tuple[Array, Array, Array, str | None]:
    """Integrate one interval by LSODA; return its samples without the last, its last state, and a failure."""
    finer = max(LSODA_TOLERANCE * rtol, FINEST), LSODA_TOLERANCE * atol
    with _LSODA, warnings.catch_warnings():
        # A warning ends the motion early, and its reason is returned.
        warnings.simplefilter("ignore")
        return _interval(rates, x, sampled, k, "LSODA", *finer, MOST_EVALUATIONS)


def _interval(
    rates: Rates, x: Array, sampled: Array, k: int, method: str, rtol: float, atol: float, most: int
) -> tuple[Array, Array, Array, str | None]:
    """Return the samples of one interval without its end, the state there, and the reason of an early stop."""
    begin, end = float(sampled[0]), float(sampled[-1])
    count = 0

    def counted(t: float, state: Array) -> Array:
        nonlocal count
        count += 1
        if count > most:
            raise TooMany(t, f"more than {most} evaluations in one interval: too stiff or divergent")
        # The search for a first step may leave the interval, where its polynomials are not defined.
        return rates(min(t, end), state, k)

    with np.errstate(all="ignore"):
        # The search for a first step does not end on NaN; later NaN shrinks the step until it underflows.
        if not np.isfinite(x).all() or not np.isfinite(rates(begin, x, k)).all():
            raise Stopped(begin, "the state or its rates are not finite")
        done = scipy.integrate.solve_ivp(counted, (begin, end), x, method=method, t_eval=sampled, rtol=rtol, atol=atol)
    found = np.reshape(done.y, (len(x), -1)).T  # a list without entries where the first step fails
    # LSODA continues after NaN.
    whole = int(np.isfinite(found).all(axis=1).cumprod().sum())
    if not done.success or whole < len(found):
        reached = max(whole, 1)
        start = found[:whole] if whole else x[None, :]
        return sampled[:reached], start, start[-1], "the step size fell below round-off: the motion diverges"
    return sampled[:-1], found[:-1], found[-1], None
