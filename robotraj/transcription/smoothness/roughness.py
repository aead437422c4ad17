"""Roughness of curves: the part that alternates with the mesh.

Values y_i are taken at the knots and in the middle of every interval. With the chord through the two neighbours of a
point, e_i = y_i - chord(t_i) is 2 d for values that alternate by +-d, and the same step again, f of e, gives 4 d. Teeth
alternate over many points, while a switch changes the signs of few. The height of teeth, peak to peak, is therefore

    max over windows of min over the window of (-1)^i f_i / 2,    of either sign,

with windows of ``WINDOW`` points. Smooth curves have the fourth power of the interval's length.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.transcription.driven_motion import Inputs
    from robotraj.transcription.extract import PhaseTrajectory

Array = NDArray[np.float64]

WINDOW = 8
"""Points of a window, which are four intervals. The signs of f alternate over six points at two switches."""


def teeth(times: Array, values: Array) -> Array:
    """Return the height of the teeth of curves, peak to peak, in their units, (n,).

    Parameters
    ----------
    times : ndarray (m,)
        Knots and middles of the intervals [s], ascending.
    values : ndarray (m, n)
        Values of n curves there.
    """
    if len(times) < WINDOW + 4:
        return np.zeros(values.shape[1])
    twice = _off_chords(times[1:-1], _off_chords(times, values))
    turned = twice * np.where(np.arange(len(twice)) % 2, -1.0, 1.0)[:, None]
    windows = np.lib.stride_tricks.sliding_window_view(turned, WINDOW, axis=0)
    heights = np.maximum(windows.min(axis=-1), -windows.max(axis=-1))
    return np.asarray(0.5 * np.maximum(heights.max(axis=0), 0.0))


def roughness(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs) -> Array:
    """Return the height of the teeth of the controls along a motion relative to their limits, (nu,).

    It is 0 for controls without a limit on a side.
    """
    if not phase.dae.controls:
        return np.zeros(0)
    lower, upper = phase.rows.limits_of(phase.dae.controls)
    sizes = np.maximum(np.abs(lower), np.abs(upper))
    breaks = trajectory.x.breaks
    _, inside = inputs.inside(np.array([0.0, 0.5, 1.0]))
    times = np.append(np.stack([breaks[:-1], 0.5 * (breaks[:-1] + breaks[1:])], axis=1).ravel(), breaks[-1])
    values = np.concatenate([inside[:, :2].reshape(-1, inside.shape[-1]), inside[-1, 2:]])
    return teeth(times, values) / np.where(sizes > 0.0, sizes, np.inf)


def _off_chords(times: Array, values: Array) -> Array:
    """Return the distance of inner values from the chords through their neighbours, (m - 2, n)."""
    share = ((times[2:] - times[1:-1]) / (times[2:] - times[:-2]))[:, None]
    return values[1:-1] - share * values[:-2] - (1.0 - share) * values[2:]
