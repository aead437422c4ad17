"""Bounds on the integral of an expression over the phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Where
from robotraj.problem.constraints.bounds import SideLike
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.scalars import PointExpression


@dataclass(frozen=True)
class IntegralConstraint(Constraint):
    """lower <= integral of expression(point) over the phase <= upper.

    Parameters
    ----------
    expression : callable
        ``expression(point)`` returns the rate, a scalar or a vector.
    lower, upper : float or sequence, optional
        Bounds on the integral; None leaves the side open.
    name, unit : str
        Label and SI unit of the integral, for reports.
    """

    expression: PointExpression
    lower: SideLike = None
    upper: SideLike = None
    name: str = "integral"
    unit: str = ""

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Count the rows and pair them with bounds, as a path constraint does."""
        path = PathConstraint(self.expression, self.lower, self.upper, self.name, self.unit)
        return replace(path.bind(dynamics, parameters), where=Where.INTEGRAL)
