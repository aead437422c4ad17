"""How violated limits of contact forces are measured: the places of an interval, and the weight of the robot.

The planner's proof and the witness share these numbers, and no other code.
"""

from __future__ import annotations

FORCE_SAMPLES = 9
"""Number of Chebyshev-Lobatto points of an interval at which contact forces are measured."""

GRAVITY = 9.81
"""Standard acceleration of free fall [m/s^2], for the weight of a robot."""

POWERS = {"N": 1, "N m": 1, "N^2": 2, "N s": 1, "N m s": 1, "N^2 s^2": 2, "m": 0, "m/s": 0, "W": 1}
"""Power of the force in the unit of a row."""


def measure(unit: str, weight: float) -> float:
    """Return the amount [unit] that counts as 1: the weight [N], its square for rows of squares; moments at 1 m."""
    return float(weight ** POWERS.get(unit, 1))
