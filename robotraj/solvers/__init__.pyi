"""Solvers are values: one file each, the only ones that know its options."""

from .base import Iteration, LazyMultipliers, Multipliers, Origin, Outcome, Progress, Solver
from .interior_point import InteriorPoint
from .ipopt import Ipopt
from .status import Status

__all__ = [
    "InteriorPoint",
    "Ipopt",
    "Iteration",
    "LazyMultipliers",
    "Multipliers",
    "Origin",
    "Outcome",
    "Progress",
    "Solver",
    "Status",
]
