"""Bounds on the height and attitude of the root."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Scalar
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between, between
from robotraj.problem.constraints.path import PathConstraint
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Upright(OneLine):
    """Bounds on height and attitude of the root in every phase of a gait.

    Without them a torque-optimal gait may lean back or turn a somersault. It may also stretch its legs, where the
    equations are singular. ``upright=None`` of the gait functions omits the bounds.

    Parameters
    ----------
    least_height, greatest_height : float
        Height of the root link's origin above the ground, relative to its height in the standing configuration.
    tilt : float
        Largest pitch of a planar root [rad]. The vector entries of a floating root's quaternion are bounded by
        |q_x|, |q_y|, |q_z| <= sin(tilt / 2), about world axes.
    """

    least_height: float = 0.6
    greatest_height: float = 1.1
    tilt: float = 0.6

    def __post_init__(self) -> None:
        if not 0.0 <= self.least_height < 1.0 < self.greatest_height or not 0.0 < self.tilt < np.pi:
            raise InputError(
                f"{self!r} is invalid: heights are relative to the standing height, the least below 1 and the greatest "
                "above; tilt is an angle from 0 to pi [rad]."
            )

    def states(self, robot: Robot) -> dict[str, Between]:
        """Return the bounds by state name, for ``rt.Phase(states=...)``."""
        if robot.root == "planar":
            return {"q.root_pitch": between(-self.tilt, self.tilt)}
        turn = float(np.sin(0.5 * self.tilt))
        return {f"q.root_{name}": between(-turn, turn) for name in ("qx", "qy", "qz")}

    def constraints(
        self, robot: Robot, standing: NDArray[np.float64], ground: Ground, rise: tuple[float, float] = (0.0, 0.0)
    ) -> list[Constraint]:
        """Return the constraint of the root link's height, for ``rt.Phase(constraints=...)``.

        ``rise`` has the least and the greatest level of the feet above ``ground`` [m].
        """
        least, greatest = self.heights(robot, standing, ground, rise)
        height = RootHeight(root_link(robot), ground)
        return [PathConstraint(height, lower=least, upper=greatest, name="root height", unit="m")]

    def heights(
        self, robot: Robot, standing: NDArray[np.float64], ground: Ground, rise: tuple[float, float] = (0.0, 0.0)
    ) -> tuple[float, float]:
        """Return the least and the greatest height of the root link above ``ground`` [m], as for ``constraints``."""
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, standing)
        x, y, z = (float(v) for v in data.oMf[robot.frame(root_link(robot))].translation)
        height = z - float(ground.height(x, y))
        return self.least_height * height + rise[0], self.greatest_height * height + rise[1]


@dataclass(frozen=True)
class RootHeight:
    """Height [m] of the origin of a frame above the ground, as an expression of a point."""

    frame: str
    ground: Ground

    def __call__(self, point: RobotPoint) -> Scalar:
        """Evaluate z - h(x, y)."""
        x, y, z = (point.frame(self.frame).position[i] for i in range(3))
        return z - self.ground.height(x, y)


def root_link(robot: Robot) -> str:
    """Return the name of the link that the root's joints move."""
    joint = {"planar": 3, "floating": 1}[robot.root]
    frames = [f for f in robot.model.frames if f.parentJoint == joint and f.type == pin.FrameType.BODY]
    return str(frames[0].name)
