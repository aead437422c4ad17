"""What a solution on a mesh says about its mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.refinement.error import interval_errors
from robotraj.refinement.strategy import Assessment
from robotraj.transcription.extract import PhaseTrajectory

if TYPE_CHECKING:
    from robotraj.problem import Phase

Array = NDArray[np.float64]


def assess(phase: Phase, trajectory: PhaseTrajectory, settled: bool) -> Assessment:
    """Errors and control jumps of every interval of a phase."""
    return Assessment(interval_errors(phase, trajectory), _jumps(trajectory), settled)


def _jumps(trajectory: PhaseTrajectory) -> Array:
    values = trajectory.u.values
    every = np.vstack(list(values))
    if not every.shape[1]:
        return np.zeros(len(values))
    span = np.ptp(every, axis=0)
    span = np.where(span > 0, span, 1.0)
    inside = np.array([np.max(np.ptp(value, axis=0) / span) for value in values])
    # A switch may also stand between the last node of one interval and the first of the next.
    ends = np.array([np.max(np.abs(b[0] - a[-1]) / span) for a, b in zip(values[:-1], values[1:], strict=True)])
    return np.maximum(inside, np.maximum(np.append(ends, 0.0), np.append(0.0, ends)))
