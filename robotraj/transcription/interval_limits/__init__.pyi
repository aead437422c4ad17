"""What holds limits between the collocation points of an interval."""

from .methods import BernsteinBounds, ConstraintGeneration

__all__ = [
    "BernsteinBounds",
    "ConstraintGeneration",
]
