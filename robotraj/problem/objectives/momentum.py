"""Integral of the squared centroidal momentum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import robot_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class CentroidalMomentum(Integral):
    """Integral over the phase of sum_i w_i h_i^2, h = (linear, angular) momentum about the centre of mass, world axes.

    Source: Orin, Goswami and Lee, Centroidal dynamics of a humanoid robot, Autonomous Robots 35 (2013).

    Parameters
    ----------
    angular : number or sequence of 3
        Weights of the angular momentum, 1 by default [1/(kg^2 m^4/s^2)].
    linear : number or sequence of 3
        Weights of the linear momentum, 0 by default [1/(kg^2 m^2/s^2)].
    """

    angular: float | Sequence[float] = 1.0
    linear: float | Sequence[float] = 0.0

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squares."""
        h = point.momentum
        return sum((w * h[i] ** 2 for i, w in enumerate(self._weights()) if w), 0.0)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check that a robot moves, and the weights."""
        robot_of(dynamics, "CentroidalMomentum")
        weights = self._weights()
        if not np.all(np.isfinite(weights)) or np.min(weights) < 0 or not np.any(weights):
            raise InputError(
                f"CentroidalMomentum(angular={self.angular!r}, linear={self.linear!r}): give weights of 0 and above, "
                "one of them positive."
            )

    def _weights(self) -> list[float]:
        try:
            halves = [np.broadcast_to(np.asarray(side, dtype=float), (3,)) for side in (self.linear, self.angular)]
        except (ValueError, TypeError) as error:
            raise InputError(
                f"CentroidalMomentum(angular={self.angular!r}, linear={self.linear!r}): give a number "
                "or 3 weights each."
            ) from error
        return [float(w) for half in halves for w in half]
