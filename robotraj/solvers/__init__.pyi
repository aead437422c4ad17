"""Solvers are values: one file each, the only ones that know its options."""

from robotraj.solvers.base import Iteration, LateMultipliers, Multipliers, Origin, Outcome, Progress, Solver
from robotraj.solvers.fatrop import Fatrop
from robotraj.solvers.ipopt import Ipopt

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
]
