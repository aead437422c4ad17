"""The time that a motion on a path loses because its control is a line between knots.

Where the limits allow s'' to bend or to jump inside an interval of length h, a line between knots differs from it by
about

    d = h (|m_k - m_{k-1}| + |m_{k+1} - m_k|) / 16

with m the slopes of the line on the interval and on its neighbours. The speed s' then misses about h d, the path
h^2 d, and the motion takes h^2 d / (2 s') longer. In least time of a panda on splines the sum over all intervals agreed
with the true loss within a factor of 2, from 48 intervals to 400. Where the line is the rate of s'', the missing s'' of
h d lasts beyond the interval, and ``LASTING`` h times as much is lost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.path_body import ACCELERATION, SPEED

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.transcription.extract import PhaseTrajectory


LASTING = 20.0
"""Number of intervals for which a missing s'' lasts, chosen so that the loss is not underestimated."""


def path_bends(phase: Phase, trajectory: PhaseTrajectory) -> Array:
    """Return the time lost on every interval [s], (K,)."""
    lengths, count = np.diff(trajectory.x.breaks), len(trajectory.x.values)
    ends = trajectory.u.inside(np.array([0.0, 1.0]))[:, :, 0]
    slopes = (ends[:, 1] - ends[:, 0]) / lengths
    bends = np.zeros(count + 1)
    bends[1:-1] = np.abs(np.diff(slopes))
    states = [state.name for state in phase.dae.states]
    speed = states.index(SPEED)
    fastest = np.abs(trajectory.x.inside(np.array([0.0, 1.0]))[:, :, speed]).max(axis=1)
    missed = LASTING * lengths if ACCELERATION in states else 1.0
    return missed * lengths**3 * (bends[1:] + bends[:-1]) / (32.0 * np.maximum(fastest, np.finfo(float).tiny))
