"""Distance from the limits of position, integrated."""

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
class JointCentering(Integral):
    """Integral over the phase of sum_j w_j ((q_j - m_j) / h_j)^2 [s], m_j the middle and h_j half the range of joint j.

    The limits are those of the robot; joints without limits on both sides do not count.

    Source: Liegeois, IEEE Transactions on Systems, Man, and Cybernetics 7 (1977).

    Parameters
    ----------
    weights : None, number, sequence or mapping by joint
        One weight for each position, 1 by default.
    """

    weights: WeightsLike = None

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squared distances from the middle."""
        limits, names = point.robot.limits, point.robot.velocity_names
        first = point.robot.nq - len(names)
        total = ca.SX(0)
        for i, weight in enumerate(weights_of(self.weights, names, "JointCentering")):
            low, high = float(limits.position_lower[i]), float(limits.position_upper[i])
            if weight and np.isfinite(low) and np.isfinite(high) and low < high:
                total += weight * ((point.q[first + i] - 0.5 * (low + high)) / (0.5 * (high - low))) ** 2
        return total

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the weights, and that a joint has limits."""
        robot = robot_of(dynamics, "JointCentering")
        weights = weights_of(self.weights, robot.velocity_names, "JointCentering")
        width = robot.limits.position_upper - robot.limits.position_lower
        if not any(w and np.isfinite(x) and x > 0 for w, x in zip(weights, width, strict=True)):
            raise InputError("JointCentering: no joint with a weight has two position limits; weigh other joints.")
