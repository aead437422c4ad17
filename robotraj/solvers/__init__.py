"""Solvers are values: one file each, the only ones that know its options."""

from robotraj.solvers.base import Iteration, Multipliers, Outcome, Progress, Solver
from robotraj.solvers.ipopt import Ipopt

__all__ = ["Ipopt", "Iteration", "Multipliers", "Outcome", "Progress", "Solver"]
