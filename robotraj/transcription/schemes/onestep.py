"""Schemes that step from knot to knot by explicit dynamics: one defect per interval, x_1 - Phi = 0."""

from __future__ import annotations

from abc import abstractmethod

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Scheme


@dataclass(frozen=True)
class OneStep(Scheme):
    """A scheme whose unknown states are at knots alone: shooting and compressed collocation.

    A scheme steps over one piece of an interval, whose control is one polynomial. An interval is one piece, except in
    single shooting, where all intervals of the mesh are the pieces of one.
    """

    def over(self, knots: Array) -> OneStep | None:
        """Return the scheme of one interval that has all those of a mesh as pieces; None for other schemes."""
        return None

    @property
    def nodes(self) -> Array:
        """Both knots."""
        return np.array([0.0, 1.0])

    @property
    def piece_sites(self) -> Array:
        """Sites of the control's values within a piece."""
        return self.control.sites(self.nodes)

    @cached_property
    def control_sites(self) -> Array:
        """Sites of the control's values in the interval."""
        return self.piece_sites

    def control_within(self, c: Array) -> Array:
        """Return the matrix from a piece's control values to the control at c in [0, 1], (len(c), sites)."""
        return basis(self.piece_sites, c)

    @property
    def inner(self) -> Array:
        """Sites strictly inside a piece at which the rows of the phase are imposed as well."""
        return np.array([])

    @property
    def pieces(self) -> Array:
        """Ends of the pieces in the interval, from 0 to 1."""
        return np.array([0.0, 1.0])

    def controls_of(self, piece: int) -> slice:
        """Return the control sites of the interval that belong to a piece."""
        return slice(None)

    @property
    def scalar_graph(self) -> bool:
        """Whether ``step`` is a scalar graph, which is unrolled and differentiated as one."""
        return True

    @property
    @abstractmethod
    def order(self) -> int | None:
        """Order of the error at the knots on smooth problems; None if the error is held to a tolerance."""

    @property
    @abstractmethod
    def degree(self) -> int:
        """Degree of the polynomial that approximates the state of a piece."""

    @abstractmethod
    def step(self, rate: ca.Function) -> ca.Function:
        """Return the step (x_0, x_1, q) -> (Phi, states at ``inner`` as columns) for dx/dc = rate(c, x, q)."""

    @abstractmethod
    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """Return the interpolant (x_0, x_1, q) -> states of the piece at sites as columns, (n, len(sites))."""
