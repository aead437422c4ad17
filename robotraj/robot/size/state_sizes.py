"""The sizes of the states of a motion, to which errors of the states are relative.

A size in a fixed unit, such as 1 m, lets a stage that moves 1 mm miss its whole motion. Sizes therefore come from the
motion itself: the same motion written in millimetres has the same relative errors.

    s_i = max(r_i, SHARE max_j r_j, ROUNDING max_k r_k)

r_i is the range of a state in the motion, of a rate (a unit per second) its largest value, since the zero of a rate is
not arbitrary. j runs over the states of the same unit: a joint that holds still while others move need be no more exact
than a share of their motion allows. k runs over all states, and keeps rounding errors of states that stay at zero from
counting as errors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

SHARE = 0.1
"""Least size of a state relative to the largest range among states of its unit."""
OFFSET = 1e-3
"""Least size of a state relative to its own largest value: an altitude of 1 km that changes by 1 m."""
ROUNDING = 1e-6
"""Least size of a state relative to the largest range of all."""
NOTHING = 1e-15
"""Ranges up to this are no motion: a pendulum that hangs still moves by 1e-21 rad in the solver's arithmetic."""
WINDOW = 0.05
"""Window of robots of ``SIZE`` or larger [s]: long enough to show an error, too short for gravity to amplify it."""
WINDOWS = 40
"""Number of windows of the whole motion of a System."""
SIZE = 0.35
"""Reach below which windows are shorter [m]."""


def state_sizes(units: Sequence[str], values: Array) -> Array:
    """Return the sizes of states (n,), in the unit of each.

    Parameters
    ----------
    units : sequence of str
        Units of the states, ``""`` where unknown.
    values : ndarray (m, n)
        States along the whole motion.

    Returns
    -------
    ndarray (n,)
        Above 0; 1 where no state moves.
    """
    peaks = np.abs(values).max(axis=0, initial=0.0)
    rates = np.array([unit.endswith("/s") for unit in units], dtype=bool)
    ranges = np.maximum(np.where(rates, peaks, np.ptp(values, axis=0)), OFFSET * peaks)
    sizes = np.maximum(ranges, ROUNDING * ranges.max(initial=0.0))
    for unit in set(units) - {""}:
        alike = np.array([each == unit for each in units], dtype=bool)
        sizes[alike] = np.maximum(sizes[alike], SHARE * ranges[alike].max())
    return np.where(sizes > NOTHING, sizes, 1.0)


def error_window(robot: Robot) -> float:
    """Return the length of a window [s]; nothing amplifies the errors of a body without reach."""
    return WINDOW * float(np.sqrt(min(1.0, (reach(robot.model) or SIZE) / SIZE)))
