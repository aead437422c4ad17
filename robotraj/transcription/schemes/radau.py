"""Radau IIA: the end of an interval is a node, its start is not. The order is 2 s - 1; stiffly accurate.

Sources: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), section IV.5; Golub and Welsch,
Calculation of Gauss quadrature rules, Mathematics of Computation 23 (1969).
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Collocation


@lru_cache(maxsize=64)
def legendre_radau(points: int) -> Array:
    """Flipped Legendre-Gauss-Radau nodes on (0, 1]: 1 and the roots of the Jacobi polynomial P^(1, 0)_{s-1}.

    The roots are eigenvalues of the matrix of its three-term recurrence. The import of scipy, which has them, takes
    longer than the solution of a small problem.
    """
    k = np.arange(points - 1)
    beside = np.sqrt(k[1:] * (k[1:] + 1.0)) / (2.0 * k[1:] + 1.0)
    matrix = np.diag(-1.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0))) + np.diag(beside, 1) + np.diag(beside, -1)
    inner = np.linalg.eigvalsh(matrix) if points > 1 else np.array([])
    nodes = 0.5 * (np.concatenate([inner, [1.0]]) + 1.0)
    nodes.setflags(write=False)
    return nodes


@dataclass(frozen=True)
class RadauIIA(Collocation):
    """Radau IIA with ``points`` collocation points per interval, order 2 points - 1."""

    points: int = 3

    def __post_init__(self) -> None:
        if not isinstance(self.points, int | np.integer) or self.points < 1:
            raise InputError(f"RadauIIA needs at least 1 point per interval, got {self.points!r}.")

    @property
    def nodes(self) -> Array:
        """Flipped Legendre-Gauss-Radau nodes."""
        return legendre_radau(self.points)

    @property
    def order(self) -> int:
        """2 s - 1."""
        return 2 * self.points - 1

    def with_points(self, points: int) -> RadauIIA:
        """Return the scheme with that many points."""
        return replace(self, points=points)
