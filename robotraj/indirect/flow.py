"""Proof of the polished trajectory: every interval is integrated again by another method.

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.5 (DOP853).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from robotraj.indirect.arcs import Side
from robotraj.indirect.pontryagin import Pontryagin
from robotraj.transcription.extract import PhaseTrajectory

Array = NDArray[np.float64]

RELATIVE, ABSOLUTE = 1e-12, 1e-13


@dataclass(frozen=True, eq=False)
class Flow:
    """The equations of an arc as numbers, algebraic variables solved for at every call."""

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

    def algebraic(self, t: float, y: Array, a: Array) -> Array:
        """Solve the algebraic rows from ``a`` by Newton's method."""
        for _ in range(8):
            if not a.size:
                break
            rows, jacobian = (np.array(part) for part in self._functions[1](t, y, a))
            step = np.linalg.solve(jacobian, rows.ravel())
            a = a - step
            if np.max(np.abs(step)) <= 1e-14 * (1.0 + np.max(np.abs(a))):
                break
        return a

    def defects(self, trajectory: PhaseTrajectory) -> Array:
        """Difference at the end of every interval between the trajectory and its integration, (K, n)."""
        breaks = trajectory.x.breaks
        rates = self._functions[0]
        found = np.empty((len(breaks) - 1, trajectory.x.size))
        for k in range(len(breaks) - 1):
            known = trajectory.z

            def rhs(t: float, y: Array, k: int = k, known: object = known) -> Array:
                a = self.algebraic(t, y, known(t, k)) if self._functions[1].size1_in(2) else np.zeros(0)  # type: ignore[operator]
                return np.array(rates(t, y, a)).ravel()

            span = (float(breaks[k]), float(breaks[k + 1]))
            start, end = trajectory.x(np.array(span), k)
            result = solve_ivp(
                rhs, span, start, method="DOP853", rtol=RELATIVE, atol=ABSOLUTE * (1.0 + np.abs(start))
            )
            found[k] = end - result.y[:, -1] if result.success else np.inf
        return found


def scales(trajectories: Sequence[PhaseTrajectory]) -> Array:
    """Size of every state, 1 + its largest magnitude, (n,)."""
    values = np.vstack([part for trajectory in trajectories for part in trajectory.x.values])
    return 1.0 + np.max(np.abs(values), axis=0)
