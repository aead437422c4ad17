"""Integral of squared torques."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class Effort(Integral):
    """Integral over the phase of sum_j w_j tau_j^2, without a half [N^2 m^2 s].

    Parameters
    ----------
    weights : None, sequence or mapping by joint
        One weight per actuated joint (per control of a System); None weighs all with 1, joints that a mapping
        does not name weigh 0.
    """

    weights: WeightsLike = None

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squared controls."""
        names = list(point.u)
        weights = self._resolved(names)
        if self.weights is None and isinstance(point.u.column, ca.SX):
            # The same graph by a single call of CasADi.
            return ca.sumsqr(point.u.column)
        return sum((w * point.u[name] ** 2 for w, name in zip(weights, names, strict=True) if w != 0.0), 0.0)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the weights against the controls."""
        if not dynamics.controls:
            raise InputError("Effort() needs controls, but the phase has none.")
        self._resolved([c.name for c in dynamics.controls])

    def _resolved(self, names: Sequence[str]) -> list[float]:
        # Controls of robots are called tau.<joint>; users weigh them by joint.
        return weights_of(self.weights, [name.removeprefix("tau.") for name in names], "Effort")
