"""Refinement: the error between knots, and the next mesh."""

from robotraj.refinement.error import interval_errors

__all__ = ["interval_errors"]
