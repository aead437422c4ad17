"""Error of the polished trajectory: every interval is integrated again by another method.

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.5 (DOP853).
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import scipy

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.indirect.arcs import Side
from robotraj.indirect.pontryagin import Pontryagin
from robotraj.transcription.extract import PhaseTrajectory

RELATIVE, ABSOLUTE = 1e-12, 1e-13
"""Tolerances of the integration."""
SAMPLE_FRACTIONS = np.array([0.0, 0.37, 0.71, 1.0])
"""Fractions of an interval at which the trajectory and the integration are compared."""
MAX_STEPS = 12
"""Largest number of Newton steps for the algebraic variables."""


@dataclass(frozen=True, eq=False)
class Flow(OneLine):
    """The equations of an arc as numeric functions; every call solves for the algebraic variables."""

    equations: Pontryagin
    sides: tuple[Side, ...]

    @cached_property
    def _functions(self) -> tuple[ca.Function, ca.Function]:
        n, m = len(self.equations.state_names), len(self.equations.algebraic_names(self.sides))
        t, y, a = ca.SX.sym("t"), ca.SX.sym("y", n), ca.SX.sym("a", m)
        rates, rows = self.equations.equations(t, y, a, self.sides)
        arguments = [t, y, a]
        jacobian = ca.densify(ca.jacobian(rows, a))
        return (
            ca.Function("rates", arguments, [ca.densify(rates)]),
            ca.Function("rows", arguments, [ca.densify(rows), jacobian]),
        )

    @cached_property
    def _explicit(self) -> ca.Function | None:
        """(t, y) -> rates if the algebraic rows are affine in their unknowns or absent; else None."""
        n, m = len(self.equations.state_names), len(self.equations.algebraic_names(self.sides))
        t, y, a = ca.SX.sym("t"), ca.SX.sym("y", n), ca.SX.sym("a", m)
        rates, rows = self.equations.equations(t, y, a, self.sides)
        jacobian = ca.jacobian(rows, a)
        if m and ca.depends_on(jacobian, a):
            return None
        if m:
            solved = -ca.solve(jacobian, ca.substitute(rows, a, ca.SX.zeros(m)))
            rates = ca.substitute(rates, a, solved)
        return ca.Function("rates", [t, y], [ca.densify(rates)])

    def algebraic(self, t: Array, y: Array, a: Array) -> Array:
        """Solve the algebraic rows at m times by Newton's method, from guesses ``a`` (m, n)."""
        m, n = a.shape
        if not n:
            return a
        rows = self._functions[1].map(m)
        for _ in range(MAX_STEPS):
            value, jacobian = (np.array(part) for part in rows(t[None, :], y.T, a.T))
            stacked = jacobian.reshape(n, m, n).transpose(1, 0, 2)
            step = np.linalg.solve(stacked, value.T[:, :, None])[:, :, 0]
            a = a - step
            if np.max(np.abs(step)) <= 1e-14 * (1.0 + np.max(np.abs(a))):
                break
        return a

    def defects(self, trajectory: PhaseTrajectory) -> Array:
        """Return the largest difference between trajectory and integration in every interval, (K, n)."""
        breaks = trajectory.x.breaks
        explicit = self._explicit
        found = np.zeros((len(breaks) - 1, trajectory.x.size))
        for k in range(len(breaks) - 1):

            def rhs(t: float, y: Array, k: int = k) -> Array:
                if explicit is not None:
                    return np.array(explicit(t, y)).ravel()
                times = np.array([t])
                a = self.algebraic(times, y[None, :], trajectory.z(times, k))
                return np.array(self._functions[0](t, y, a[0])).ravel()

            stops = breaks[k] + (breaks[k + 1] - breaks[k]) * SAMPLE_FRACTIONS
            y = trajectory.x(stops[:1], k)[0]
            for first, last in zip(stops[:-1], stops[1:], strict=True):
                absolute = ABSOLUTE * (1.0 + np.abs(y))
                result = scipy.integrate.solve_ivp(rhs, (first, last), y, method="DOP853", rtol=RELATIVE, atol=absolute)
                y = result.y[:, -1] if result.success else np.full(len(y), np.inf)
                found[k] = np.maximum(found[k], np.abs(trajectory.x(np.array([last]), k)[0] - y))
                if not result.success:
                    break
        return found


def scales(trajectories: Sequence[PhaseTrajectory]) -> Array:
    """Return the size of every state, 1 + its largest magnitude, (n,)."""
    values = np.vstack([part for trajectory in trajectories for part in trajectory.x.values])
    return 1.0 + np.max(np.abs(values), axis=0)
