"""The base class of physical quantities of a robot that a phase's parameter can set."""

from __future__ import annotations

from abc import ABC, abstractmethod

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj.dynamics.design.bodies import Bodies
from robotraj.dynamics.variable import Scalar
from robotraj.robot.loading.planning_model import names_of
from robotraj.robot.robot import Robot


class Quantity(OneLine, ABC):
    """A physical quantity of the robot that a parameter sets; a frozen value.

    Attributes
    ----------
    description : str
        Label for messages: ``"mass of body"``.
    after_others : bool
        Whether it is applied after the other quantities. A payload is added to a body whose mass is a parameter.
    """

    description: str
    after_others: bool = False

    @property
    @abstractmethod
    def target(self) -> str:
        """Name of its joint, link or frame."""

    @property
    def label(self) -> str:
        """Label with the name: ``mass of body 'forearm'``."""
        return f"{self.description} {self.target!r}"

    @abstractmethod
    def unit(self, robot: Robot) -> str:
        """SI unit of the parameter."""

    @abstractmethod
    def check(self, robot: Robot) -> tuple[object, ...]:
        """Check names against the robot and return a key.

        Two quantities of a phase must not have equal keys, except the empty key ().

        Raises
        ------
        InputError
            The robot has no such body, frame or joint, or its quantity cannot change.
        """

    @abstractmethod
    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Write the value, a symbol or a number, into the bodies."""

    def check_lower(self, name: str, lower: float) -> None:
        """Check that the lower bound of a parameter excludes negative values.

        Raises
        ------
        InputError
            The bound is negative; the message names the parameter and the quantity.
        """
        if lower < 0:
            raise InputError(
                f"Parameter {name!r} is the {self.label} and may be as low as {lower:g}; "
                "bound it from below with 0 or more, such as rt.between(0.1, 2)."
            )


def body_of_name(robot: Robot, name: str, what: str) -> int:
    """Return Pinocchio's index of the joint that moves a body, from the name of the joint, a link or another frame.

    Raises
    ------
    InputError
        There is no such name, or it belongs to the world.
    """
    model = robot.model
    if name in names_of(model)[1:]:
        return int(model.getJointId(name))
    if name not in robot.frame_names:
        links = [frame.name for frame in model.frames if frame.parentJoint > 0]
        advice = f"{what} needs a link or a joint."
        raise unknown_name("body", name, dict.fromkeys([*robot.joint_names, *links]), advice)
    joint = int(model.frames[robot.frame(name)].parentJoint)
    if joint == 0:
        raise InputError(
            f"{what}: {name!r} does not move; name a link or frame behind one of the joints "
            f"{', '.join(robot.joint_names)}."
        )
    return joint
