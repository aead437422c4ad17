"""Bounds on the variables of the dynamics, by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint
from robotraj.problem.constraints.bounds import Interval, as_bounds
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class VariableBounds(Constraint):
    """lower <= s <= upper for named states, controls or algebraic variables.

    Parameters
    ----------
    kind : str
        ``"state"``, ``"control"`` or ``"algebraic variable"``: where the names are looked up.
    bounds : mapping of str to number, Between or None
    """

    kind: str
    bounds: Mapping[str, Interval]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each variable that is bounded on a side."""
        of_kind = {"state": dynamics.states, "control": dynamics.controls, "algebraic variable": dynamics.algebraic}
        vector = {"state": "x", "control": "u", "algebraic variable": "z"}[self.kind]
        variables = of_kind[self.kind]
        lower, upper = as_bounds(dict(self.bounds), [v.name for v in variables], f"{self.kind} bounds", self.kind)
        given = [
            (variable, float(low), float(high))
            for variable, low, high in zip(variables, lower, upper, strict=True)
            if np.isfinite(low) or np.isfinite(high)
        ]
        rows = tuple(Row(f"{self.kind} bound", v.unit, low, high, v.label, v.name) for v, low, high in given)

        def expression(point: Point) -> list[Scalar]:
            return [getattr(point, vector)[variable.name] for variable, *_ in given]

        return BoundConstraint(f"{self.kind} bounds", rows, expression)
