"""Collocation on Lagrange polynomials: the nodes of a scheme determine its Butcher table.

On an interval of length h the state is the polynomial of degree s with

    x(0) = x_0,    xdot(c_j) = f_j,    j = 1..s,

so that x(tau) = x_0 + h sum_k f_k int_0^tau l_k. At the nodes this reads x_j = x_0 + h sum_k A_jk f_k with
A_jk = int_0^{c_j} l_k, and at the end x_1 = x_0 + h sum_k b_k f_k with b_k = int_0^1 l_k.
Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.7.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import field

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis, integrals
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.control import Control, PolynomialControl
from robotraj.transcription.schemes.quadrature import OwnQuadrature, Quadrature


@dataclass(frozen=True)
class Scheme(OneLine, ABC):
    """A discretisation of the intervals of a mesh.

    Parameters
    ----------
    control : Control
        Shape of the control inside an interval.
    """

    control: Control = field(default_factory=PolynomialControl, kw_only=True)

    @property
    @abstractmethod
    def nodes(self) -> Array:
        """Nodes c, (s,), in [0, 1]: states there are unknowns, and the rows of the phase are imposed there."""

    @cached_property
    def control_sites(self) -> Array:
        """Sites of the control's values in [0, 1]."""
        return self.control.sites(self.nodes)

    @cached_property
    def control_at_nodes(self) -> Array:
        """Matrix from the control's values at its sites to its values at the nodes, (s, m)."""
        return basis(self.control_sites, self.nodes)


@dataclass(frozen=True)
class Collocation(Scheme):
    """Collocation at nodes 0 <= c_1 < ... < c_s <= 1.

    Parameters
    ----------
    control : Control
        Shape of the control inside an interval.
    quadrature : Quadrature
        Weights of the objective's integrand.
    """

    quadrature: Quadrature = field(default_factory=OwnQuadrature, kw_only=True)

    @property
    @abstractmethod
    def order(self) -> int:
        """Order of the error at the knots on smooth problems, with the scheme's own control and quadrature."""

    @abstractmethod
    def with_points(self, points: int) -> Collocation:
        """Return the scheme of the same family, control and quadrature with another number of nodes."""

    @cached_property
    def matrix(self) -> Array:
        """Butcher matrix A, (s, s)."""
        return integrals(self.nodes, self.nodes)

    @cached_property
    def weights(self) -> Array:
        """Butcher weights b, (s,)."""
        if self.nodes[-1] == 1.0:
            # The last row of A integrates to the end as well.
            return self.matrix[-1]
        return integrals(self.nodes, np.array([1.0]))[0]

    @cached_property
    def objective_weights(self) -> Array:
        """Weights of the objective's integrand at the nodes, (s,)."""
        return self.quadrature.weights(self.nodes, self.weights)
