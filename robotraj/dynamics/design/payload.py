"""A point mass carried at a frame as a parameter."""

from __future__ import annotations

import casadi as ca

from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies, Body
from robotraj.dynamics.design.quantity import Quantity, body_of_name
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Payload(Quantity):
    """The parameter m is a point mass [kg] at the origin of a frame, in addition to the body's mass.

    r is the frame's origin in its joint's frame. The payload adds m to the body's mass and m r to its first moment h.
    It adds m (r'r 1 - r r') to the inertia about the joint's origin. On a body with a ``LinkLength`` r is scaled as
    well.

    Parameters
    ----------
    frame : str
        The frame, on a moving body.
    """

    frame: str
    description = "payload at"
    after_others = True

    @property
    def target(self) -> str:
        """Name of the frame."""
        return self.frame

    def unit(self, robot: Robot) -> str:
        """Kilograms."""
        return "kg"

    def check(self, robot: Robot) -> tuple[object, ...]:
        """Check that the frame moves; a frame may have several payloads."""
        robot.frame(self.frame)
        body_of_name(robot, self.frame, "rt.design.Payload")
        return ()

    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Add the moments of the point mass."""
        frame = bodies.robot.frame(self.frame)
        joint = int(bodies.robot.model.frames[frame].parentJoint)
        r, body = bodies.frame_translation(frame), bodies.body(joint)
        second = body.second + value * ca.mtimes(r, r.T)
        bodies.set_body(joint, Body(body.mass + value, body.first + value * r, second))
