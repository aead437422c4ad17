"""The time over which the errors of a plan add up before they are judged.

A small error of an unstable motion grows without bound in an open-loop simulation, but not over a short window. How
short depends on the robot: gravity amplifies errors at the rate sqrt(g / l), so that a robot of 0.1 m falls three times
as fast as one of 1 m. Windows of small robots are therefore a fixed share of their natural time sqrt(l / g). The proof
uses these windows, and validation up to twice as long ones for motions of many windows.

The states of a System have no size that is known. Proof and validation cut its motion into ``WINDOWS`` windows.
"""

from __future__ import annotations

import numpy as np

from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

WINDOW = 0.05
"""Window of robots of ``SIZE`` or larger [s]: long enough to show an error, too short for gravity to amplify it."""
WINDOWS = 40
"""Number of windows of the whole motion of a System."""
SIZE = 0.35
"""Reach below which windows are shorter [m]."""


def error_window(robot: Robot) -> float:
    """Return the length of a window [s]; nothing amplifies the errors of a body without reach."""
    return WINDOW * float(np.sqrt(min(1.0, (reach(robot.model) or SIZE) / SIZE)))
