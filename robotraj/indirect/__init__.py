"""The indirect view of a direct solution: costates, the necessary conditions, and Pontryagin's boundary value problem."""

from robotraj.indirect.costates import Costates, CostateSample, PhaseCostates, costates

__all__ = ["CostateSample", "Costates", "PhaseCostates", "costates"]
