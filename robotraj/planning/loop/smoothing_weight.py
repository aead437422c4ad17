"""The weight of smoothing where limits of a frame's speed or acceleration determine the time.

The joints share such a limit, and many of their motions take the same time. Their torques and accelerations are far
from limits of their own. What is smoothed (``transcription.smoothness``), the mean m over the motion, is then so small
that the solver stops before the motion is smooth. Joints that oscillate also exceed the limit between the points.

With u from 0 to 1 the mean of the vector's length relative to its limit, the weight on later meshes is

    epsilon ((1 - u) + u / m).

Where the frame is at its limit nearly all the time, smoothing is the share epsilon of the duration. A limit that the
motion does not come near changes nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from robotraj.dynamics.row import Magnitude
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.transcription.driven_motion import PlannedInputs
from robotraj.transcription.interval_limits.row_values import Expressions
from robotraj.transcription.refinement.objective_quadrature import squares_cost
from robotraj.transcription.smoothness.smoothing import weight_of_duration

PLACES = np.array([0.25, 0.75])
"""Places of an interval at which limits are evaluated."""


def smoothing_weight(epsilon: float, parts: Sequence[PhaseSolution]) -> float:
    """Return the weight of smoothing for the meshes after the first one, whose motion is given.

    Parameters
    ----------
    epsilon : float
        Weight on the first mesh.
    parts : sequence of PhaseSolution
    """
    durations = sum(weight_of_duration(part.phase) * part.duration for part in parts)
    cost = sum(squares_cost(part.phase, part.trajectory, part.mesh.schemes, 1.0) for part in parts)
    if cost <= 0.0:
        return epsilon
    used = max((share for part in parts for share in _used(part)), default=0.0)
    return epsilon * (1.0 - used + used * durations / cost)


def _used(part: PhaseSolution) -> Iterator[float]:
    """Yield the mean share that a motion uses of each limit of a frame."""
    rows = [
        row for row in (*part.phase.rows.of_state, *part.phase.rows.of_inputs) if isinstance(row.measure, Magnitude)
    ]
    if not rows:
        return
    values = Expressions(part.phase.rows, rows, part.trajectory, PlannedInputs(part.trajectory)).grid(PLACES)
    shares = np.minimum(np.sqrt(np.maximum(values, 0.0)), 1.0).mean(axis=1)
    lengths = np.diff(part.trajectory.x.breaks)
    yield from (lengths @ shares / lengths.sum()).tolist()
