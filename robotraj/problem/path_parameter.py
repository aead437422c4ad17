"""Dynamics of a robot on a path q(s) with three further variables: the path parameter s, its speed s' and s''."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import ClassVar

import casadi as ca
import numpy as np

from robotraj._util.trajectory import PiecewisePolynomial
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import TimeOrders
from robotraj.dynamics.point import AnyPoint, Point
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import Augmented
from robotraj.problem.scalars import Scalar

PARAMETER, SPEED, ACCELERATION = "path.s", "path.speed", "path.acceleration"
"""Names of the added states and of the added control."""


@dataclass(frozen=True)
class PathParameter(Augmented):
    """Further states s and s' and a further control s'':   ds/dt = s',   ds'/dt = s''.

    Attributes
    ----------
    first, last : mapping of str to float
        Values of the states that are fixed at the start and at the end.
    """

    first: Mapping[str, float] = field(default_factory=dict)
    last: Mapping[str, float] = field(default_factory=dict)
    smooth: ClassVar[bool] = True

    @property
    def states(self) -> tuple[Variable, ...]:
        """Inner states, then s and s'."""
        return (
            *self.inner.states,
            Variable(PARAMETER, "", "path parameter"),
            Variable(SPEED, "1/s", "path speed"),
        )

    @property
    def controls(self) -> tuple[Variable, ...]:
        """Inner controls, then s''."""
        return (*self.inner.controls, Variable(ACCELERATION, "1/s^2", "path acceleration"))

    @property
    def start(self) -> Mapping[str, float]:
        """Values of s and s' at the start."""
        return {**super().start, **self.first}

    @property
    def end(self) -> Mapping[str, float]:
        """Values of s and s' at the end."""
        return {**super().end, **self.last}

    @property
    def time_orders(self) -> TimeOrders | None:
        """0 for s, 1 for s', 2 for s''."""
        known = self._inner_orders
        return known and known._replace(states=(*known.states, 0, 1), controls=(*known.controls, 2))

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put s, s' and s'' into ``point.extra``."""
        nx, nu = len(self.inner.states), len(self.inner.controls)
        point = self.inner.point(t, x[:nx, :], z, None if u is None else u[:nu, :], p, names)
        point.extra |= {PARAMETER: x[nx], SPEED: x[nx + 1]}
        if u is not None:
            point.extra[ACCELERATION] = u[nu]
        return point

    def rates(self, point: AnyPoint) -> ca.SX:
        """Inner rates, then s' and s''."""
        return ca.vertcat(self.inner.rates(point), point.extra[SPEED], point.extra[ACCELERATION])


def values_on(path: PiecewisePolynomial, s: Scalar) -> Sequence[Scalar]:
    """Return the n values of a path at a parameter: numbers for a number, else expressions of a symbol.

    With [s >= b_k] = 1 beyond the break b_k, the coefficients of the piece that s lies in are
    c_0 + sum_k [s >= b_k] (c_k - c_{k-1}). The first and the last piece extend beyond the ends.
    """
    if not isinstance(s, ca.SX):
        return [float(value) for value in path(float(s))]
    degree = max(len(sites) for sites in path.sites)
    rows = []
    for start, end, sites, values in zip(path.breaks, path.breaks[1:], path.sites, path.values, strict=False):
        powers = np.linalg.solve(np.vander(np.asarray(sites), increasing=True), np.asarray(values))
        powers = powers / ((end - start) ** np.arange(len(powers)))[:, None]
        rows.append(np.concatenate([[start], np.pad(powers, ((0, degree - len(powers)), (0, 0))).ravel()]))
    chosen = ca.SX(ca.DM(rows[0]))
    for before, row in zip(rows[:-1], rows[1:], strict=True):
        chosen += (s >= row[0]) * ca.SX(ca.DM(row - before))
    along, n = s - chosen[0], path.size
    found = []
    for i in range(n):
        value = chosen[1 + (degree - 1) * n + i]
        for d in range(degree - 2, -1, -1):
            value = value * along + chosen[1 + d * n + i]
        found.append(value)
    return found
