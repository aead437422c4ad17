"""Objectives: values that add up and scale."""

from robotraj.objectives.base import EndCost, Integral, Objective, Sum
from robotraj.objectives.duration import Duration
from robotraj.objectives.effort import Effort
from robotraj.objectives.lagrange import Lagrange
from robotraj.objectives.mayer import Mayer

__all__ = ["Duration", "Effort", "EndCost", "Integral", "Lagrange", "Mayer", "Objective", "Sum"]
