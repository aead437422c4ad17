"""Lobatto IIIA: nodes at both knots and at the extrema of a Legendre polynomial between them.

Two points give the trapezoidal rule, three Hermite-Simpson, five the fifth-degree Gauss-Lobatto method of Herman and
Conway. Order 2 s - 2.
Sources: Hairer and Wanner, Solving ODEs II (1996), section IV.5; Kelly, SIAM Review 59 (2017), sections 3 and 4;
Herman and Conway, Journal of Guidance, Control, and Dynamics 19 (1996).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Collocation


@lru_cache(maxsize=64)
def legendre_lobatto(points: int) -> Array:
    """Legendre-Gauss-Lobatto nodes on [0, 1]: 0, 1 and the roots of P'_{s-1}."""
    if points <= 3:
        inner = np.zeros(points - 2)  # saves the import of numpy.polynomial
    else:
        inner = np.sort(np.polynomial.legendre.Legendre.basis(points - 1).deriv().roots().real)
    # The nodes are symmetric. Averaging the halves removes the round-off of the root finder.
    inner = 0.5 * (inner - inner[::-1])
    nodes = 0.5 * (np.concatenate([[-1.0], inner, [1.0]]) + 1.0)
    nodes.setflags(write=False)
    return nodes


@dataclass(frozen=True)
class LobattoIIIA(Collocation):
    """Lobatto IIIA with ``points`` collocation points per interval, order 2 points - 2."""

    points: int = 3

    def __post_init__(self) -> None:
        if not isinstance(self.points, int | np.integer) or self.points < 2:
            raise InputError(f"LobattoIIIA needs at least 2 points per interval, got {self.points!r}.")

    @property
    def nodes(self) -> Array:
        """Legendre-Gauss-Lobatto nodes."""
        return legendre_lobatto(self.points)

    @property
    def order(self) -> int:
        """2 s - 2."""
        return 2 * self.points - 2

    def with_points(self, points: int) -> LobattoIIIA:
        """Return Lobatto IIIA with that many points."""
        return LobattoIIIA(points, control=self.control, quadrature=self.quadrature)


@dataclass(frozen=True)
class Trapezoidal(Collocation):
    """The trapezoidal rule, x_1 = x_0 + h (f_0 + f_1) / 2: Lobatto IIIA with 2 points, order 2."""

    @property
    def nodes(self) -> Array:
        """Both knots."""
        return legendre_lobatto(2)

    @property
    def order(self) -> int:
        """Order 2."""
        return 2

    def with_points(self, points: int) -> LobattoIIIA:
        """Return Lobatto IIIA with that many points."""
        return LobattoIIIA(points, control=self.control, quadrature=self.quadrature)


@dataclass(frozen=True)
class HermiteSimpson(Collocation):
    """Hermite-Simpson: Lobatto IIIA with 3 points, cubic states, order 4.

    In separated form: x_m = (x_0 + x_1) / 2 + h (f_0 - f_1) / 8 and x_1 = x_0 + h (f_0 + 4 f_m + f_1) / 6, written
    here as the equivalent rows of the Butcher matrix. ``control=LinearControl(), quadrature=TrapezoidalQuadrature()``
    is the lecture's variant; the default has a free mid-point and Simpson's rule.
    """

    @property
    def nodes(self) -> Array:
        """Knots and mid-point."""
        return legendre_lobatto(3)

    @property
    def order(self) -> int:
        """Order 4."""
        return 4

    def with_points(self, points: int) -> LobattoIIIA:
        """Return Lobatto IIIA with that many points."""
        return LobattoIIIA(points, control=self.control, quadrature=self.quadrature)


@dataclass(frozen=True)
class FifthDegree(Collocation):
    """Fifth-degree Gauss-Lobatto (Herman and Conway 1996): Lobatto IIIA with 5 points, order 8."""

    @property
    def nodes(self) -> Array:
        """Five Legendre-Gauss-Lobatto nodes."""
        return legendre_lobatto(5)

    @property
    def order(self) -> int:
        """Order 8."""
        return 8

    def with_points(self, points: int) -> LobattoIIIA:
        """Return Lobatto IIIA with that many points."""
        return LobattoIIIA(points, control=self.control, quadrature=self.quadrature)
