"""Refinement: the error between knots, and the next mesh."""

from robotraj.refinement.assess import assess
from robotraj.refinement.error import interval_errors, state_errors
from robotraj.refinement.orders import RaiseOrder, SplitOrRaise
from robotraj.refinement.strategy import Assessment, Refinement, SplitAndMerge

__all__ = [
    "Assessment",
    "RaiseOrder",
    "Refinement",
    "SplitAndMerge",
    "SplitOrRaise",
    "assess",
    "interval_errors",
    "state_errors",
]
