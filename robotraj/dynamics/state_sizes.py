"""Sizes of the states of a System, to which errors of a motion are relative.

Units of a user's states are not known: an altitude of 15 km may cross zero, an angle may stay below 1e-3 rad. A state
therefore counts by its largest value in a phase, not by its value at a time. The planner's estimate of the error
between the knots and the local errors of ``rt.validate`` both use these sizes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SMALLEST = 1e-2
"""Size of a state that stays below it, for example of one that is zero throughout."""


def state_sizes(peaks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return max(``SMALLEST``, peak) for the largest magnitudes of states in a phase, (n,) or (m, n)."""
    return np.maximum(SMALLEST, peaks)
