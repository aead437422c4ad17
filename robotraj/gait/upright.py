"""Bounds that keep a robot on its feet."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.path import PathConstraint
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Upright:
    """Rows that every phase of a gait gets, so that the optimum is one of a robot on its feet.

    Without them a torque-optimal gait may lean back, turn a somersault, or rise until its legs are straight, which cost
    no torque and can move no further: the equations are singular there. They are part of what the gait functions
    write and can be taken out again, or left out with ``upright=None``.

    Parameters
    ----------
    least_height, greatest_height : float
        Height of the root link's origin above the ground, as shares of its height when standing.
    tilt : float
        Greatest pitch of a planar root [rad]; for a floating root the greatest roll, pitch and yaw by which each vector
        entry of its quaternion is bounded, |q_x|, |q_y|, |q_z| <= sin(tilt / 2), about world axes.
    """

    least_height: float = 0.6
    greatest_height: float = 1.1
    tilt: float = 0.6

    def __post_init__(self) -> None:
        if not 0.0 <= self.least_height < 1.0 < self.greatest_height or not 0.0 < self.tilt < np.pi:
            raise InputError(
                f"{self!r}: heights are shares of the standing height, the least below 1 and the greatest above; tilt "
                "is an angle from 0 to pi [rad]."
            )

    def states(self, robot: Robot) -> dict[str, Any]:
        """Bounds by state name, for ``rt.Phase(states=...)``."""
        if robot.root == "planar":
            return {"q.root_pitch": between(-self.tilt, self.tilt)}
        turn = float(np.sin(0.5 * self.tilt))
        return {f"q.root_{name}": between(-turn, turn) for name in ("qx", "qy", "qz")}

    def constraints(self, robot: Robot, standing: NDArray[np.float64], ground: Ground) -> list[Constraint]:
        """Range of the root link's height, for ``rt.Phase(constraints=...)``."""
        link = root_link(robot)
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, standing)
        x, y, z = (float(v) for v in data.oMf[robot.frame(link)].translation)
        height = z - float(ground.height(x, y))
        return [
            PathConstraint(
                RootHeight(link, ground),
                lower=self.least_height * height,
                upper=self.greatest_height * height,
                name="root height",
                unit="m",
            )
        ]


@dataclass(frozen=True)
class RootHeight:
    """Height [m] of a frame's origin above the ground, of a point."""

    frame: str
    ground: Ground

    def __call__(self, point: Any) -> Any:
        """Evaluate z - h(x, y)."""
        x, y, z = (point.frame(self.frame).position[i] for i in range(3))
        return z - self.ground.height(x, y)


def root_link(robot: Robot) -> str:
    """Name of the link that the root's joints carry."""
    joint = {"planar": 3, "floating": 1}[robot.root]
    frames = [f for f in robot.model.frames if f.parentJoint == joint and f.type == pin.FrameType.BODY]
    return str(frames[0].name)
