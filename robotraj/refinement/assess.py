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
    return Assessment(interval_errors(phase, trajectory), _jumps(trajectory), _decays(trajectory), settled)


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


def _decays(trajectory: PhaseTrajectory) -> Array:
    """Slope of log10 |c_n| over the degree n of the states' Legendre coefficients, least over the states."""
    decays = []
    for sites, values in zip(trajectory.x.sites, trajectory.x.values, strict=True):
        degree = len(sites) - 1
        coefficients = np.abs(np.polynomial.legendre.legfit(2 * sites - 1, values, degree))
        scale = np.maximum(np.abs(values).max(axis=0), 1e-8)
        # What lies below round-off says nothing of smoothness.
        logs = np.log10(np.maximum(coefficients / scale, 1e-14))
        slopes = np.polyfit(np.arange(1, degree + 1), logs[1:], 1)[0] if degree > 1 else logs[1] - logs[0]
        moving = coefficients[1:].max(axis=0) > 1e-10 * scale
        decays.append(float(np.min(-slopes[moving], initial=np.inf)))
    return np.array(decays)
