"""Path rows with equal bounds that fix a function of the state, and the rates of that function.

An equation h(t, x, p) = c has order r if its rates h', ..., h^(r-1), along dx/dt = f, read neither controls nor
algebraic variables and h^(r) does. The pose of a frame has order 2, because accelerations are chosen.
``transcription.collocation.index_reduction`` says how equations of order 2 and more are imposed.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed., section VI.7.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import casadi as ca

from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point

HIGHEST = 4
"""Rates that are tried at most: their expressions grow, and robots have no equations of higher order."""


@dataclass(frozen=True, eq=False)
class EqualityRates:
    """One path row that is an equation of order r >= 2.

    Attributes
    ----------
    row : int
        Its number among the path rows of the phase.
    order : int
        r.
    values : casadi.Function
        (t, x, p) -> (h, h', ..., h^(r-1)).
    chosen : casadi.Function
        (t, x, z, u, p) -> h^(r).
    target : float
        c, in the unit of the row.
    """

    row: int
    order: int
    values: ca.Function
    chosen: ca.Function
    target: float

    def expressions(self) -> tuple[ca.SX, ca.SX]:
        """Return symbols (t, x, p) in one column, and h - c, h', ... as expressions of them."""
        arguments = [ca.SX.sym(name, self.values.size1_in(i)) for i, name in enumerate("txp")]
        return ca.vertcat(*arguments), self.values(*arguments) - ca.DM([self.target] + [0.0] * (self.order - 1))


def equality_rates(
    dae: Dynamics,
    parameters: Sequence[str],
    targets: Mapping[int, float],
    rows: Callable[[Point], ca.SX],
) -> tuple[EqualityRates, ...]:
    """Find the equations of order 2 and more.

    Parameters
    ----------
    dae : Dynamics
    parameters : sequence of str
        Names of the parameters of the phase.
    targets : mapping of int to float
        Numbers of the rows with equal bounds, and these bounds.
    rows : callable
        ``rows(point)`` returns all path rows as a column.
    """
    sizes = (1, len(dae.states), len(dae.algebraic), len(dae.controls), len(parameters))
    t, x, z, u, p = (ca.SX.sym(name, size) for name, size in zip("txzup", sizes, strict=True))
    point = dae.point(t, x, z, u, p, parameters)
    values, inner = rows(point), ca.vertcat(z, u)
    flow: ca.SX | None = None
    found = []
    for i, target in targets.items():
        rate = values[i]
        rates: list[ca.SX] = []
        while len(rates) < HIGHEST and not ca.depends_on(rate, inner) and ca.depends_on(rate, x):
            rates.append(rate)
            flow = dae.rates(point) if flow is None else flow
            rate = ca.mtimes(ca.jacobian(rate, x), flow) + ca.jacobian(rate, t)
        if ca.depends_on(rate, inner) and len(rates) > 1:
            known = ca.Function("values", [t, x, p], [ca.vertcat(*rates)])
            chosen = ca.Function("chosen", [t, x, z, u, p], [rate])
            found.append(EqualityRates(i, len(rates), known, chosen, target))
    return tuple(found)
