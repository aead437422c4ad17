"""Schemes that step from knot to knot by explicit dynamics: one defect per interval, x_1 - Phi = 0."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import basis
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Scheme

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OneStep(Scheme):
    """What shooting and compressed collocation share: the states of an interval are unknown at its knots alone.

    A scheme says how one piece of an interval is stepped over; the control of a piece is one polynomial. An
    interval is one piece, but in single shooting, where all intervals of the mesh are the pieces of one.
    """

    def over(self, knots: Array) -> OneStep | None:
        """Make one interval of all intervals of a mesh, or None where each is stepped over by itself."""
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
        """Matrix from a piece's control values to the control at c in [0, 1] of the piece, (len(c), sites)."""
        return basis(self.piece_sites, c)

    @property
    def inner(self) -> Array:
        """Sites strictly inside a piece where the rows of the phase hold as well."""
        return np.array([])

    @property
    def pieces(self) -> Array:
        """Ends of the pieces in the interval, from 0 to 1."""
        return np.array([0.0, 1.0])

    def controls_of(self, piece: int) -> slice:
        """Which of the interval's control sites belong to a piece."""
        return slice(None)

    @property
    def scalar_graph(self) -> bool:
        """Whether ``step`` is a plain expression, which is unrolled and differentiated as one."""
        return True

    @property
    @abstractmethod
    def order(self) -> int | None:
        """Order of the error at the knots on smooth problems; None where it is held to a tolerance."""

    @property
    @abstractmethod
    def degree(self) -> int:
        """Degree of the polynomial that stands for the state of a piece."""

    @abstractmethod
    def step(self, rate: ca.Function) -> ca.Function:
        """(x_0, x_1, q) -> (Phi, states at ``inner`` as columns), for dx/dc = rate(c, x, q) over a piece."""

    @abstractmethod
    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """(x_0, x_1, q) -> states of the piece at sites as columns, (n, len(sites)): the interpolant of the scheme."""
