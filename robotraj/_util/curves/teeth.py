"""Teeth of curves: the part that alternates with the mesh.

Values y_i are taken at the knots and in the middle of every interval. With the chord through the two neighbours of a
point, e_i = y_i - chord(t_i) is 2 d for values that alternate by +-d, and the same step again, f of e, gives 4 d. Teeth
alternate over many points, while a switch changes the signs of few. The height of teeth, peak to peak, is therefore

    max over windows of min over the window of (-1)^i f_i / 2,    of either sign,

with windows of ``WINDOW`` points. Smooth curves have the fourth power of the interval's length.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array

WINDOW = 8
"""Points of a window, which are four intervals. The signs of f alternate over six points at two switches."""
SMOOTH = 0.02
"""Largest height of teeth of a control, relative to its limit."""


def teeth(times: Array, values: Array) -> Array:
    """Return the height of the teeth of curves, peak to peak, in their units, (n,).

    Parameters
    ----------
    times : ndarray (m,)
        Knots and middles of the intervals [s], ascending.
    values : ndarray (m, n)
        Values of n curves there.
    """
    return np.asarray(heights(times, values).max(axis=0, initial=0.0))


def heights(times: Array, values: Array) -> Array:
    """Return the heights of the teeth in every window, (w, n)."""
    if len(times) < WINDOW + 4:
        return np.zeros((0, values.shape[1]))
    twice = _off_chords(times[1:-1], _off_chords(times, values))
    turned = twice * np.where(np.arange(len(twice)) % 2, -1.0, 1.0)[:, None]
    windows = np.lib.stride_tricks.sliding_window_view(turned, WINDOW, axis=0)
    heights = np.maximum(windows.min(axis=-1), -windows.max(axis=-1))
    return np.asarray(0.5 * np.maximum(heights, 0.0))


def _off_chords(times: Array, values: Array) -> Array:
    """Return the distance of inner values from the chords through their neighbours, (m - 2, n)."""
    share = ((times[2:] - times[1:-1]) / (times[2:] - times[:-2]))[:, None]
    return values[1:-1] - share * values[:-2] - (1.0 - share) * values[2:]
