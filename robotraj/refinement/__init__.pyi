"""Refinement: the error between knots, and the next mesh."""

from robotraj.refinement.assess import assess, errors_of
from robotraj.refinement.error import interval_errors, state_errors
from robotraj.refinement.integrals import integral_errors
from robotraj.refinement.orders import RaiseOrder, SplitOrRaise
from robotraj.refinement.strategy import Assessment, Refinement, SplitAndMerge

__all__ = [
    "Assessment",
    "RaiseOrder",
    "Refinement",
    "SplitAndMerge",
    "SplitOrRaise",
    "assess",
    "errors_of",
    "integral_errors",
    "interval_errors",
    "state_errors",
]
