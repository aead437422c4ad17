"""Weights that integrate the objective over an interval."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


class Quadrature(OneLine, ABC):
    """Weights w_j of the integrand at the collocation points of a unit interval."""

    @abstractmethod
    def weights(self, nodes: Array, own: Array) -> Array:
        """Return the weights at ``nodes``; ``own`` are the scheme's."""


@dataclass(frozen=True)
class OwnQuadrature(Quadrature):
    """The scheme's own weights b: Simpson's for Hermite-Simpson."""

    def weights(self, nodes: Array, own: Array) -> Array:
        """Return the scheme's weights."""
        return own


@dataclass(frozen=True)
class TrapezoidalQuadrature(Quadrature):
    """Half the length at each end of the interval, order 2."""

    def weights(self, nodes: Array, own: Array) -> Array:
        """Return one half at the first and last collocation points, zeros between.

        Raises
        ------
        InputError
            The scheme does not collocate at both ends of its intervals.
        """
        if nodes[0] != 0.0 or nodes[-1] != 1.0:
            raise InputError(
                "TrapezoidalQuadrature needs a scheme with collocation points at both knots: a Lobatto scheme."
            )
        weights = np.zeros(len(nodes))
        weights[[0, -1]] = 0.5
        return weights
