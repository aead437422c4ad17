"""Refinement: the error between knots, and the next mesh."""

from robotraj.refinement.assess import assess
from robotraj.refinement.error import interval_errors
from robotraj.refinement.strategy import Assessment, Refinement, SplitAndMerge

__all__ = ["Assessment", "Refinement", "SplitAndMerge", "assess", "interval_errors"]
