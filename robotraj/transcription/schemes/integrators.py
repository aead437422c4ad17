"""Integrators over a unit interval, as differentiable CasADi functions.

An integrator solves dx/dc = rate(c, x, q) from c = 0 to c = 1, where q are the other arguments of the rate. Its dense
output can be sampled at any sites of [0, 1].
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


class Integrator(OneLine, ABC):
    """An integrator of shooting; a further one is a class derived from this."""

    @property
    @abstractmethod
    def degree(self) -> int:
        """Degree of the polynomial that approximates the dense output of an interval."""

    @abstractmethod
    def flow(self, rate: ca.Function) -> ca.Function:
        """Return the function (x, q) -> x(1) for rate(c, x, q)."""

    @abstractmethod
    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """Return the function (x, q) -> x at the sites as columns, (n, len(sites))."""


@dataclass(frozen=True)
class RungeKutta4(Integrator):
    """The classical method of order 4 with equal substeps; its dense output is the cubic Hermite of each substep.

    With h = 1 / substeps, k1 = f(c, x), k2 = f(c + h/2, x + h k1/2), k3 = f(c + h/2, x + h k2/2) and
    k4 = f(c + h, x + h k3),

        x(c + h) = x + h (k1 + 2 k2 + 2 k3 + k4) / 6.

    Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sections II.1 and II.6.

    Parameters
    ----------
    substeps : int
        Steps per interval.

    Raises
    ------
    InputError
        Fewer than one substep.
    """

    substeps: int = 4

    def __post_init__(self) -> None:
        if not isinstance(self.substeps, int | np.integer) or self.substeps < 1:
            raise InputError(f"RungeKutta4 needs at least 1 substep per interval, got {self.substeps!r}.")

    @property
    def degree(self) -> int:
        """Degree of the polynomial through values and slopes at the ends of the substeps, 33 at most."""
        return int(min(2 * self.substeps + 1, 33))

    def flow(self, rate: ca.Function) -> ca.Function:
        """Return the substeps as one scalar graph."""
        x, q, ends, _ = self._march(rate)
        return ca.Function("flow", [x, q], [ends[-1]])

    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """Return the cubic Hermite interpolant of the substeps."""
        x, q, ends, slopes = self._march(rate)
        slopes.append(rate(1.0, ends[-1], q))
        columns, h = [], 1.0 / self.substeps
        for site in sites:
            i = min(int(site * self.substeps), self.substeps - 1)
            s = site * self.substeps - i
            columns.append(
                (1 + 2 * s) * (1 - s) ** 2 * ends[i]
                + s * s * (3 - 2 * s) * ends[i + 1]
                + h * s * (1 - s) * ((1 - s) * slopes[i] - s * slopes[i + 1])
            )
        return ca.Function("samples", [x, q], [ca.horzcat(*columns)])

    def _march(self, rate: ca.Function) -> tuple[ca.SX, ca.SX, list[ca.SX], list[ca.SX]]:
        """Return symbols of x and q, the states at the ends of the substeps, and the slopes at their starts."""
        x, q = ca.SX.sym("x", rate.size1_in(1)), ca.SX.sym("q", rate.size1_in(2))
        h = 1.0 / self.substeps
        ends, slopes = [x], []
        for i in range(self.substeps):
            c, now = i * h, ends[-1]
            k1 = rate(c, now, q)
            k2 = rate(c + h / 2, now + h / 2 * k1, q)
            k3 = rate(c + h / 2, now + h / 2 * k2, q)
            k4 = rate(c + h, now + h * k3, q)
            ends.append(now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
            slopes.append(k1)
        return x, q, ends, slopes


@dataclass(frozen=True)
class Adaptive(Integrator):
    """CVODES with variable order and step to a tolerance (Adams, or BDF for stiff equations).

    First and second derivatives are integrated as well, by forward and adjoint sensitivity equations, so that the NLP
    has an exact Hessian. They take about ten integrations an interval and are as accurate as the tolerance. Prefer
    ``RungeKutta4`` where a fixed step is accurate enough.

    Source: Hindmarsh et al., SUNDIALS: suite of nonlinear and differential/algebraic equation solvers, ACM
    Transactions on Mathematical Software 31 (2005).

    Parameters
    ----------
    tolerance : float
        Relative and absolute tolerance of every step.
    stiff : bool
        Backward differentiation formulas in place of Adams's method.

    Raises
    ------
    InputError
        A tolerance outside 1e-14 to 1e-2.
    """

    tolerance: float = 1e-10
    stiff: bool = False

    def __post_init__(self) -> None:
        if not (is_number(self.tolerance) and 1e-14 <= self.tolerance <= 1e-2):
            raise InputError(f"Adaptive(tolerance) must lie between 1e-14 and 1e-2, got {self.tolerance!r}.")

    @property
    def degree(self) -> int:
        """Degree 16, which represents a few steps of the method to round-off."""
        return 16

    def flow(self, rate: ca.Function) -> ca.Function:
        """Return the integral from 0 to 1."""
        return self._integrate(rate, np.array([1.0]))

    def samples(self, rate: ca.Function, sites: Array) -> ca.Function:
        """Return the states at the sites, at each of which the integrator stops."""
        later = np.asarray(sites)[np.asarray(sites) > 0.0]
        x, q = ca.MX.sym("x", rate.size1_in(1)), ca.MX.sym("q", rate.size1_in(2))
        found = self._integrate(rate, later)(x, q)
        return ca.Function("samples", [x, q], [ca.horzcat(*[x] * (len(sites) - len(later)), found)])

    def _integrate(self, rate: ca.Function, until: Array) -> ca.Function:
        n, m = rate.size1_in(1), rate.size1_in(2)
        c, x, q = ca.SX.sym("c"), ca.SX.sym("x", n), ca.SX.sym("q", m)
        options = {
            "reltol": self.tolerance,
            "abstol": self.tolerance,
            "linear_multistep_method": "bdf" if self.stiff else "adams",
            "max_num_steps": 100_000,
            # Derivatives by parameters are quadratures; without error control they are wrong (casadi issue
            # 4383).
            "quad_err_con": True,
            "show_eval_warnings": False,
        }
        grid: list[float] = [float(site) for site in until]
        integrator = ca.integrator("flow", "cvodes", {"t": c, "x": x, "p": q, "ode": rate(c, x, q)}, 0.0, grid, options)
        start, more = ca.MX.sym("x", n), ca.MX.sym("q", m)
        return ca.Function("flow", [start, more], [integrator(x0=start, p=more)["xf"]])
