"""The gear ratio of a motor as a parameter."""

from __future__ import annotations

import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies
from robotraj.dynamics.design.quantity import Quantity
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class GearRatio(Quantity):
    """The parameter n is the gear ratio between a motor and its joint: the armature is I n^2 [kg m^2].

    It replaces the armature of the robot. ``tau`` and limits stay those of the joint. The motor turns n times as fast
    and gives tau / n: ``rt.PathConstraint(lambda point: point.tau[i] / point.p["n"], lower=-2, upper=2)`` bounds its
    torque, and the same with ``point.v[i] * point.p["n"]`` its speed. Losses and the turning of the rotor with its link
    are neglected.

    Source: Featherstone, Rigid Body Dynamics Algorithms (2008), section 9.6.

    Parameters
    ----------
    joint : str
        A moving joint.
    rotor : float
        Inertia I of the rotor about its axis [kg m^2]; for a prismatic joint n is in rad/m, and the armature in kg.
    """

    joint: str
    rotor: float
    description = "gear ratio of joint"

    @property
    def target(self) -> str:
        """Name of the joint."""
        return self.joint

    def unit(self, robot: Robot) -> str:
        """None for a revolute joint, rad/m for a prismatic one."""
        return "" if robot.units[robot.joint(self.joint)] == "rad" else "rad/m"

    def check(self, robot: Robot) -> tuple[object, ...]:
        """Check that the joint exists and that the inertia is a number above 0."""
        if not is_number(self.rotor) or not 0.0 < self.rotor < np.inf:
            raise InputError(
                f"GearRatio({self.joint!r}, rotor={self.rotor!r}): rotor= is an inertia [kg m^2], a number above 0."
            )
        return GearRatio, robot.joint(self.joint)

    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Replace the armature."""
        bodies.set_armature(bodies.robot.joint(self.joint), self.rotor * value**2)
