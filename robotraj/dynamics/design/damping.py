"""The viscous damping of a joint as a parameter."""

from __future__ import annotations

from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies
from robotraj.dynamics.design.quantity import Quantity
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot

DAMPING_UNITS = {"rad": "N m s/rad", "m": "N s/m"}


@dataclass(frozen=True)
class JointDamping(Quantity):
    """The parameter d is the viscous damping of a joint: torque -d v [N m s/rad, N s/m].

    Parameters
    ----------
    joint : str
        A moving joint.
    """

    joint: str
    description = "damping of joint"

    @property
    def target(self) -> str:
        """Name of the joint."""
        return self.joint

    def unit(self, robot: Robot) -> str:
        """N m s/rad for a revolute joint, N s/m for a prismatic one."""
        return DAMPING_UNITS[robot.units[robot.joint(self.joint)]]

    def check(self, robot: Robot) -> tuple[object, ...]:
        """Check that the joint exists."""
        return JointDamping, robot.joint(self.joint)

    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Replace the damping of the URDF."""
        bodies.set_damping(bodies.robot.joint(self.joint), value)
