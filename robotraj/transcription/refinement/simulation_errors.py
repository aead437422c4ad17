"""Errors of a plan as ``rt.validate`` measures them: over short windows, and of speeds inside intervals.

Betts's error of an interval (``error``) is relative to the largest acceleration of a joint, and counts intervals one by
one. Where many short intervals follow each other, as where powers change their sign, their errors add up, and a
simulation of a window misses its end. The error over a window is the sum of its intervals,

    error = max_i |integral e_i dt| / s_i,    e = xdot - f,

with the sizes s_i of the states (``robot.size.state_sizes``). Windows end inside of longer
intervals, where the error is larger than at the end: there collocation integrates e to nearly zero. An interval has the
share of the error of a window that its own error has of the mean in the window, at most the whole.

A light joint whose motor overcomes dry friction reaches its speed within a fraction of an interval, and then holds it
by damping. The collocated speed is right at the knots and wrong inside the interval. Relative to an acceleration of
10,000 rad/s^2 this error is small, but a simulation that follows the plan is away from it by a fraction of the speed.
The deviation d of each speed is integrated from 0 at the first knot of an interval,

    d' = e - lambda d,    error = max_t |d| / s,

with the rates of decay lambda of ``error``, the size s of the speed, and implicit steps between
the points of Gauss's rule.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import gauss, integrals
from robotraj._util.precision import SAME
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.error import Residuals

SHARE = 0.2
"""Factor on the error of a window to compare it with the error of an interval.

At the default goal of 1e-4 it allows half the error that ``rt.validate`` allows a window."""
SHARE_OF_SPEEDS = 2e-3
"""Factor on the deviation of a speed to compare it with the error of an interval.

At the default goal of 1e-4 it allows half the deviation that ``rt.validate`` allows a robot that follows its plan."""


def errors_of_simulations(
    trajectory: PhaseTrajectory, residuals: Residuals, longest: float, sizes: Array, speeds: slice
) -> Array:
    """Return the larger error of every interval: of the windows around it, or of the speeds inside it, (K,).

    Parameters
    ----------
    trajectory : PhaseTrajectory
    residuals : Residuals
    longest : float
        Length of a window [s]. Longer intervals are cut into equal parts.
    sizes : ndarray (nx,)
        Sizes of the states.
    speeds : slice
        Columns of the states that are speeds of joints.
    """
    of_speeds = SHARE_OF_SPEEDS * speed_deviations(residuals, sizes, speeds)
    return np.maximum(errors_of_windows(trajectory, residuals, longest, sizes), of_speeds)


def errors_of_windows(trajectory: PhaseTrajectory, residuals: Residuals, longest: float, sizes: Array) -> Array:
    """Return the error of the worst window around every interval, to compare with that of one, (K,)."""
    return SHARE * window_errors(trajectory, residuals, longest, sizes)


def window_errors(trajectory: PhaseTrajectory, residuals: Residuals, longest: float, sizes: Array) -> Array:
    """Return the error of the worst window around every interval, (K,).

    Parameters
    ----------
    trajectory, residuals, longest, sizes
        See ``errors_of_simulations``.
    """
    breaks = trajectory.x.breaks
    lengths = np.diff(breaks)
    parts = np.maximum(1, np.ceil(lengths / longest * (1.0 - SAME))).astype(int)
    owners = np.repeat(np.arange(len(lengths)), parts)
    ends = np.concatenate(
        [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(breaks[:-1], breaks[1:], parts, strict=True)]
    )
    begins = np.append(breaks[0], ends[:-1])
    eta = _integrals(residuals, lengths, parts, longest)
    sums = np.vstack([np.zeros(eta.shape[1]), np.cumsum(eta, axis=0)])
    errors = np.zeros(len(lengths))
    for first, begin in enumerate(begins):
        last = max(first + 1, int(np.searchsorted(ends, begin + longest * (1.0 + SAME), side="right")))
        window = slice(first, last)
        of_window = np.abs(sums[last] - sums[first]) / sizes
        own = np.abs(eta[window])
        shares = np.minimum(1.0, own / np.maximum(own.mean(axis=0), 1e-300))
        np.maximum.at(errors, owners[window], (shares * of_window).max(axis=1))
    return errors


def speed_deviations(residuals: Residuals, sizes: Array, speeds: slice) -> Array:
    """Return the largest deviation of a speed inside every interval, relative to its size, (K,)."""
    counts = np.bincount(residuals.interval)
    starts = np.cumsum(counts) - counts
    driven = residuals.weights[:, None] * residuals.values[:, speeds]
    decay = 0.0 if residuals.decay is None else residuals.decay[:, speeds]
    damped = np.broadcast_to(1.0 + residuals.weights[:, None] * decay, driven.shape)
    deviations = np.zeros((len(counts), driven.shape[1]))
    largest = np.zeros_like(deviations)
    for place in range(counts.max()):
        own = counts > place
        at = starts[own] + place
        deviations[own] = (deviations[own] + driven[at]) / damped[at]
        largest[own] = np.maximum(largest[own], np.abs(deviations[own]))
    return np.asarray((largest / sizes[speeds]).max(axis=1))


def _integrals(residuals: Residuals, lengths: Array, parts: NDArray[np.int_], longest: float) -> Array:
    """Integrate the residuals over the parts of every interval, (sum of parts, nx)."""
    values = residuals.effects(np.maximum(lengths, longest))
    points = np.split(values, np.searchsorted(residuals.interval, np.arange(1, len(lengths))))
    matrices: dict[tuple[int, int], Array] = {}
    found = []
    for length, count, own in zip(lengths, parts, points, strict=True):
        key = len(own), int(count)
        if key not in matrices:
            sites = 0.5 * (gauss(len(own))[0] + 1.0)
            matrices[key] = np.diff(integrals(sites, np.linspace(0.0, 1.0, count + 1)), axis=0)
        found.append(length * matrices[key] @ own)
    return np.concatenate(found)
