"""Refinement: the error between knots, and the next mesh."""

from .assess import assess, errors_of
from .base import Assessment, Refinement
from .equidistribution import Equidistribute
from .error import interval_errors, state_errors
from .integrals import integral_errors
from .raise_order import RaiseOrder, SplitOrRaise
from .split_and_merge import SplitAndMerge

__all__ = [
    "Assessment",
    "Equidistribute",
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
