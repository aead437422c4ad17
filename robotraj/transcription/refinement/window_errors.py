"""Errors of a robot's plan over short windows of time, as ``rt.validate`` measures them.

Betts's error of an interval (``error``) is relative to the largest acceleration of a joint, and counts intervals one by
one. Where many short intervals follow each other, as where powers change their sign, their errors add up, and a
simulation of 0.05 s misses its end. The error over a window is the sum of its intervals,

    error = max_i |integral e_i dt| / (1 + |x_i|),    e = xdot - f,

with the state x_i at its end. An interval has the share of it that its own error has of the mean in the window, at most
the whole.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.error import Residuals

Array = NDArray[np.float64]

WINDOW = 0.05
"""Length of a window [s]; a longer interval counts by the share of a window."""
SHARE = 0.1
"""Factor on the error of a window to compare it with that of an interval, which is allowed a tenth of it."""


def window_errors(trajectory: PhaseTrajectory, residuals: Residuals) -> Array:
    """Return the error of the worst window around every interval, times ``SHARE``, (K,)."""
    breaks = trajectory.x.breaks
    lengths = np.diff(breaks)
    count, states = len(lengths), residuals.values.shape[1]
    eta = np.zeros((count, states))
    np.add.at(eta, residuals.interval, residuals.effects(np.maximum(lengths, WINDOW)))
    sums = np.vstack([np.zeros(states), np.cumsum(eta, axis=0)])
    sizes = 1.0 + np.abs(trajectory.x(breaks[1:], np.arange(count)))
    errors = np.zeros(count)
    for first in range(count):
        last = max(first + 1, int(np.searchsorted(breaks, breaks[first] + WINDOW, side="right")) - 1)
        window = slice(first, last)
        of_window = np.abs(sums[last] - sums[first]) / sizes[last - 1]
        own = np.abs(eta[window])
        shares = np.minimum(1.0, own / np.maximum(own.mean(axis=0), 1e-300))
        worst = (shares * of_window).max(axis=1) * min(1.0, WINDOW / float(lengths[window].sum()))
        errors[window] = np.maximum(errors[window], worst)
    return np.asarray(SHARE * errors)
