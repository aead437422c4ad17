"""Solvers are values: one file each, the only ones that know its options."""

from .base import Iteration, LateMultipliers, Multipliers, Origin, Outcome, Progress, Solver
from .fatrop import Fatrop
from .ipopt import Ipopt
from .status import Status

__all__ = [
    "Fatrop",
    "Ipopt",
    "Iteration",
    "LateMultipliers",
    "Multipliers",
    "Origin",
    "Outcome",
    "Progress",
    "Solver",
    "Status",
]
