"""Variation of the joints' speeds, which makes motions of least time unique."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import robot_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class SpeedVariation(Integral):
    """Integral over the phase of sum_j w_j (sqrt(r_j^2 + c^2) - c) [1], r_j = a_j / v_max_j the relative acceleration.

    For |r_j| far above c it is the total variation of v_j / v_max_j: 2 for a joint that reaches its limit of speed
    once, however short the acceleration. Where a limit of the tool's speed determines the duration, many motions of the
    joints are equally short. Those that oscillate exploit the gaps between the points. With 1e-3 of this integral
    beside ``rt.Duration()`` the plan is unique, and longer by at most 2e-3 s for each such joint.

    Parameters
    ----------
    weights : None, number, sequence or mapping by joint
        One weight for each velocity, 1 by default.
    smoothing : float
        The constant c [1/s]. Slower relative accelerations cost their square.

    Notes
    -----
    v_max_j is the limit of the robot; 1 rad/s or 1 m/s for a joint without a limit.
    """

    weights: WeightsLike = None
    smoothing: float = 10.0

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of smoothed magnitudes of relative accelerations."""
        names, limits, c = point.robot.velocity_names, point.robot.limits.largest("velocity"), self.smoothing
        scales = np.where(np.isfinite(limits) & (limits > 0.0), limits, 1.0)
        weighed = zip(weights_of(self.weights, names, "SpeedVariation"), scales.tolist(), strict=True)
        return sum((w * (ca.sqrt((point.a[i] / v) ** 2 + c**2) - c) for i, (w, v) in enumerate(weighed) if w), ca.SX(0))

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the weights and the constant."""
        weights_of(self.weights, robot_of(dynamics, "SpeedVariation").velocity_names, "SpeedVariation")
        if not 0.0 < self.smoothing < np.inf:
            raise InputError(f"SpeedVariation(smoothing) is {self.smoothing!r}; it must be finite and above 0.")
