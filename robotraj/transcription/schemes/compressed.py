"""Hermite-Simpson in compressed form: the state at the mid-point is eliminated.

    x_m = (x_0 + x_1) / 2 + h (f_0 - f_1) / 8,    x_1 - x_0 - h (f_0 + 4 f(x_m, u_m) + f_1) / 6 = 0

It has half the states and defects of the separated form (``HermiteSimpson``), with the same solution. Since f is
composed with itself, the rows are more nonlinear, and a solver may not converge from a distant guess. ``rt.plan``
therefore solves the separated form first, whose solution is the guess of the compressed one.
Source: Kelly, SIAM Review 59 (2017), section 4; Betts, Practical Methods for Optimal Control (2010), section
4.6.6.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import integrals
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.lobatto import HermiteSimpson, legendre_lobatto
from robotraj.transcription.schemes.onestep import OneStep


@dataclass(frozen=True)
class CompressedHermiteSimpson(OneStep):
    """Hermite-Simpson with one defect per interval, order 4; rows of the phase hold at knots and mid-points.

    The dynamics must be explicit: a robot is planned by its forward dynamics. Solutions are those of
    ``HermiteSimpson()``, which is solved first, by inverse dynamics if they are the phase's. Where that is solved and
    the compressed form is not, as with steep dry friction of light joints, its solution is returned. Solvers need the
    fewest iterations by inverse dynamics, the default of ``HermiteSimpson()``.

    Parameters
    ----------
    control : Control
        A free mid-point by default.
    """

    @property
    def separated(self) -> HermiteSimpson:
        """The separated form, with the state at the mid-point as an unknown."""
        return HermiteSimpson(control=self.control)

    @property
    def piece_sites(self) -> Array:
        """Knots and mid-point by default; else the sites of the control."""
        return self.control.sites(legendre_lobatto(3))

    @property
    def inner(self) -> Array:
        """The mid-point."""
        return np.array([0.5])

    @property
    def order(self) -> int:
        """Order 4."""
        return 4

    @property
    def degree(self) -> int:
        """Degree 3."""
        return 3

    def step(self, rate: ca.Function) -> ca.Function:
        """Return Simpson's rule with the mid-point on the Hermite cubic."""
        x0, x1, q, slopes, middle = self._stages(rate)
        return ca.Function("step", [x0, x1, q], [x0 + ca.mtimes(slopes, ca.DM([1, 4, 1]) / 6), middle])

    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """Return the integral of the parabola through the three slopes."""
        x0, x1, q, slopes, _ = self._stages(rate)
        weights = integrals(legendre_lobatto(3), sites)
        columns = ca.repmat(x0, 1, len(sites)) + ca.mtimes(slopes, ca.DM(weights.T))
        return ca.Function("samples", [x0, x1, q], [columns])

    def _stages(self, rate: ca.Function) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """Return x0, x1, q, the slopes at both knots and the mid-point as columns, and the state at the mid-point."""
        x0, x1, q = (ca.SX.sym(n, rate.size1_in(i)) for n, i in (("x0", 1), ("x1", 1), ("q", 2)))
        first, last = rate(0.0, x0, q), rate(1.0, x1, q)
        middle = (x0 + x1) / 2 + (first - last) / 8
        return x0, x1, q, ca.horzcat(first, rate(0.5, middle, q), last), middle
