"""Gauss-Legendre: all nodes lie inside the interval. Order 2 s, the highest of all schemes with s points.

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.7.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import gauss
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Collocation


@lru_cache(maxsize=64)
def legendre_gauss(points: int) -> Array:
    """Legendre-Gauss nodes on (0, 1): the roots of P_s."""
    nodes = 0.5 * (gauss(points)[0] + 1.0)
    nodes.setflags(write=False)
    return nodes


@dataclass(frozen=True)
class GaussLegendre(Collocation):
    """Gauss-Legendre with ``points`` collocation points per interval, order 2 points.

    Parameters
    ----------
    points : int
    joined : bool
        Whether accelerations of robots with a motor at every joint are continuous at the knots. With three points
        motions are those of Hermite-Simpson, with Gauss's rule for the objective in place of Simpson's.
    """

    points: int = 2
    joined: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.points, int | np.integer) or self.points < 1:
            raise InputError(f"GaussLegendre needs at least 1 point per interval, got {self.points!r}.")

    @property
    def nodes(self) -> Array:
        """Legendre-Gauss nodes."""
        return legendre_gauss(self.points)

    @property
    def order(self) -> int:
        """2 s."""
        return 2 * self.points

    def with_points(self, points: int) -> GaussLegendre:
        """Return the scheme with that many points."""
        return replace(self, points=points)
