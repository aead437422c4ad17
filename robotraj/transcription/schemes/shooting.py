"""Multiple and single shooting: the defect of an interval contains an integrator.

    x_{k+1} - Phi(x_k, u_k, T, p) = 0

The unknowns of multiple shooting are the states at all knots. Those of single shooting are the states at both ends of
the phase alone; the first is integrated over all intervals. Rows of the phase are imposed at knots. Rows of the state
are added between the knots where a solution violates them. Dynamics must be explicit: a robot is planned by its forward
dynamics.
Sources: Bock and Plitt, A multiple shooting algorithm for direct solution of optimal control problems, IFAC
World Congress (1984); Betts, Practical Methods for Optimal Control (2010), sections 3.4 and 4.2.
"""

from __future__ import annotations

from dataclasses import field

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.control import ConstantControl, Control
from robotraj.transcription.schemes.integrators import Integrator, RungeKutta4
from robotraj.transcription.schemes.onestep import OneStep

CALLS = {"max_num_dir": 4}
"""Options of functions that are called, not expanded: directions of a derivative function. With CasADi's 64, single
shooting of a ur5 took 54 s and 2 GB before its first iteration, and 3 s with 4."""


@dataclass(frozen=True)
class Shooting(OneStep):
    """Base of multiple and single shooting.

    Parameters
    ----------
    integrator : Integrator
        ``RungeKutta4(substeps)`` or ``Adaptive(tolerance)``.
    control : Control
        Constant by default, or linear. A polynomial control is linear here, since no nodes lie between knots.
    """

    integrator: Integrator = field(default_factory=RungeKutta4)
    control: Control = field(default_factory=ConstantControl, kw_only=True)

    @property
    def scalar_graph(self) -> bool:
        """Whether the integrator is a Runge-Kutta method; an adaptive one is called as a function."""
        return isinstance(self.integrator, RungeKutta4)

    @property
    def order(self) -> int | None:
        """4 for Runge-Kutta, for the parametrised control; None for an adaptive integrator."""
        return 4 if isinstance(self.integrator, RungeKutta4) else None

    @property
    def degree(self) -> int:
        """Degree of the integrator's dense output."""
        return self.integrator.degree

    def step(self, rate: ca.Function) -> ca.Function:
        """Return the integral; it does not depend on the state at the end of the piece."""
        flow = self.integrator.flow(rate)
        kind = ca.SX if self.scalar_graph else ca.MX
        x0, x1, q = (kind.sym(n, rate.size1_in(i)) for n, i in (("x0", 1), ("x1", 1), ("q", 2)))
        return ca.Function("step", [x0, x1, q], [flow(x0, q), kind(rate.size1_in(1), 0)], CALLS)

    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """Return the dense output of the integrator."""
        dense = self.integrator.samples(rate, sites)
        x0, x1, q = (ca.MX.sym(n, rate.size1_in(i)) for n, i in (("x0", 1), ("x1", 1), ("q", 2)))
        return ca.Function("samples", [x0, x1, q], [dense(x0, q)], CALLS)


@dataclass(frozen=True)
class MultipleShooting(Shooting):
    """Multiple shooting: the states at all knots are unknowns; one integration per interval."""


@dataclass(frozen=True)
class SingleShooting(Shooting):
    """Single shooting: one integration from the first state to the last, controls piece by piece.

    Rows and bounds of states are imposed on the integrated states at the knots. Every unknown acts on all later states,
    so that matrices are dense. For unstable or long motions, use multiple shooting or collocation.
    """

    def over(self, knots: Array) -> Shot:
        """Return the scheme of the one interval."""
        return Shot(self.integrator, tuple(knots), control=self.control)


@dataclass(frozen=True)
class Shot(Shooting):
    """The one interval of single shooting, whose pieces are the intervals of the mesh."""

    knots: tuple[float, ...] = (0.0, 1.0)

    @property
    def pieces(self) -> Array:
        """The knots of the mesh."""
        return np.array(self.knots)

    @property
    def scalar_graph(self) -> bool:
        """False: the pieces are calls of functions."""
        return False

    @property
    def _shared(self) -> bool:
        """Whether neighbouring pieces share the control's value between them."""
        return bool(self.piece_sites[0] == 0.0 and self.piece_sites[-1] == 1.0)

    def controls_of(self, piece: int) -> slice:
        """Return the control sites of a piece."""
        count = len(self.piece_sites)
        first = piece * (count - 1 if self._shared else count)
        return slice(first, first + count)

    @cached_property
    def control_sites(self) -> Array:
        """Sites of all pieces."""
        own = self.piece_sites[:-1] if self._shared else self.piece_sites
        sites = (self.pieces[:-1, None] + np.diff(self.pieces)[:, None] * own).ravel()
        return np.append(sites, 1.0) if self._shared else sites

    @cached_property
    def control_at_nodes(self) -> Array:
        """Matrix from the control's values to those at the ends of the phase, by the first and the last piece."""
        at_ends = np.zeros((2, len(self.control_sites)))
        last = len(self.pieces) - 2
        within = self.control_within(np.array([0.0, 1.0]))
        at_ends[0, self.controls_of(0)] = within[0]
        at_ends[1, self.controls_of(last)] = within[1]
        return at_ends
