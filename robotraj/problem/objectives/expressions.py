"""Objectives that the user writes: an expression of a point that is integrated, or one of a phase's two ends."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.expression_values import rows_of
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import ends_of, symbols_of
from robotraj.problem.objectives.base import EndCost, Integral
from robotraj.problem.scalars import EndExpression, PointExpression, Scalar


@dataclass(frozen=True)
class Lagrange(Integral):
    """Integral of ``expression(point)`` over the phase: ``rt.Lagrange(lambda point: point.u["u"] ** 2)``.

    ``rt.PathConstraint`` lists the attributes of a point.
    """

    expression: PointExpression

    def rate(self, point: RobotPoint) -> Scalar:
        """Integrand at a point."""
        return self.expression(point)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Try the expression on symbols."""
        what = "Lagrange expression of the objective"
        rows = rows_of(what, self.expression, symbols_of(dynamics, parameters))
        if len(rows) != 1:
            raise InputError(f"A Lagrange expression must return one scalar; it returned {len(rows)}.")


@dataclass(frozen=True)
class Mayer(EndCost):
    """Cost of the end points: ``rt.Mayer(lambda start, end: end.x["m"])``.

    The end points have ``t``, ``x``, ``p`` and, for robots, ``q``, ``v``, frames and the centre of mass.
    """

    expression: EndExpression

    def value(self, start: RobotPoint, end: RobotPoint) -> Scalar:
        """Cost of the end points."""
        return self.expression(start, end)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Try the expression on symbols."""
        what = "Mayer expression of the objective"
        rows = rows_of(what, self.expression, *ends_of(dynamics, parameters))
        if len(rows) != 1:
            raise InputError(f"A Mayer expression must return one scalar; it returned {len(rows)}.")
