"""Roughness of a motion's controls: the height of their teeth, relative to their limits."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.teeth import WINDOW, heights
from robotraj.problem.phase import Phase
from robotraj.transcription.driven_motion import Inputs
from robotraj.transcription.extract import PhaseTrajectory


def roughness(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs) -> Array:
    """Return the height of the teeth of the controls along a motion relative to their limits, (nu,).

    It is 0 for controls without a limit on a side.
    """
    return np.asarray(_relative(phase, trajectory, inputs).max(axis=0, initial=0.0))


def rough_intervals(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs) -> Array:
    """Return the roughness of the roughest control on every interval, (K,)."""
    highest = _relative(phase, trajectory, inputs).max(axis=1, initial=0.0)
    found = np.zeros(len(trajectory.x.breaks) - 1)
    # The first value of f is that of the second knot, and every second point is a knot.
    for offset in range(0, WINDOW, 2):
        np.maximum.at(found, 1 + (np.arange(len(highest)) + offset) // 2, highest)
    return found


def _relative(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs) -> Array:
    """Return the heights of the teeth in every window relative to the controls' limits, (w, nu)."""
    if not phase.dae.controls:
        return np.zeros((0, 0))
    lower, upper = phase.rows.limits_of(phase.dae.controls)
    sizes = np.maximum(np.abs(lower), np.abs(upper))
    breaks = trajectory.x.breaks
    _, inside = inputs.inside(np.array([0.0, 0.5, 1.0]))
    times = np.append(np.stack([breaks[:-1], 0.5 * (breaks[:-1] + breaks[1:])], axis=1).ravel(), breaks[-1])
    values = np.concatenate([inside[:, :2].reshape(-1, inside.shape[-1]), inside[-1, 2:]])
    return heights(times, values) / np.where(sizes > 0.0, sizes, np.inf)
