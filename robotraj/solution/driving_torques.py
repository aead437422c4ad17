"""Torques along a motion of a robot with a motor at every joint, by inverse dynamics."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.printing import OneLine
from robotraj._util.trajectory import PiecewisePolynomial
from robotraj._util.values import dataclass
from robotraj.robot.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrivingTorques(OneLine):
    """tau(t) = RNEA(q, v, vdot) + D v + F tanh(v / v_s), with damping D and smoothed Coulomb friction F.

    Attributes
    ----------
    robot : Robot
        With a motor at every joint.
    x : PiecewisePolynomial
        Positions, then speeds.
    """

    robot: Robot
    x: PiecewisePolynomial

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        return self.x.breaks

    @cached_property
    def _rates(self) -> PiecewisePolynomial:
        return self.x.derivative()

    def __call__(self, t: Any, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Evaluate at times.

        Parameters
        ----------
        t : float or array (m,)
            [s].
        interval : int, optional
            Read the polynomials of this interval, for one-sided values at knots.

        Returns
        -------
        ndarray (nu,) or (m, nu)
            [N m, N], in the order of the robot's actuated joints.
        """
        return self._of(self.x(t, interval), self._rates(t, interval))

    def inside(self, tau: Array) -> Array:
        """Evaluate every interval at the same places tau in [0, 1], (m,) -> (K, m, nu)."""
        return self._of(self.x.inside(tau), self._rates.inside(tau))

    def _of(self, x: Array, rates: Array) -> Array:
        robot, n = self.robot, self.robot.nv
        model, data = robot.model, robot.model.createData()
        q, v, a = x[..., :n], x[..., n : 2 * n], rates[..., n : 2 * n]
        each = zip(q.reshape(-1, n), v.reshape(-1, n), a.reshape(-1, n), strict=True)
        found = np.array([pin.rnea(model, data, *state) for state in each]).reshape(q.shape)
        if robot.damping.any():
            found += robot.damping * v
        if robot.friction.any():
            found += robot.friction * np.tanh(v / robot.friction_speed)
        return np.asarray(found[..., self._order])

    @cached_property
    def _order(self) -> list[int]:
        return [self.robot.velocity_names.index(joint) for joint in self.robot.actuated]
