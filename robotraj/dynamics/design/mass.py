"""The mass of a body as a parameter."""

from __future__ import annotations

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies, Body
from robotraj.dynamics.design.quantity import Quantity, body_of_name
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class BodyMass(Quantity):
    """The parameter m is the mass of a body [kg]; its density is scaled.

    With m0 the URDF's mass: h = (m/m0) h0 and I = (m/m0) I0 about any point. The centre of mass does not move.

    Parameters
    ----------
    body : str
        A link, or the joint that moves it. The body consists of all links that move rigidly with that joint, also
        those attached by fixed or locked joints.
    """

    body: str
    description = "mass of body"

    @property
    def target(self) -> str:
        """Name of the body."""
        return self.body

    def unit(self, robot: Robot) -> str:
        """Kilograms."""
        return "kg"

    def check(self, robot: Robot) -> tuple[object, ...]:
        """Check that the body moves and has a mass."""
        joint = body_of_name(robot, self.body, "rt.design.BodyMass")
        if not robot.model.inertias[joint].mass > 0:
            raise InputError(
                f"rt.design.BodyMass: body {self.body!r} has no mass in the URDF that could be scaled; "
                "add one with rt.design.Payload(frame)."
            )
        return BodyMass, joint

    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Scale all moments by m/m0."""
        joint = body_of_name(bodies.robot, self.body, "rt.design.BodyMass")
        body = bodies.body(joint)
        ratio = value / bodies.robot.model.inertias[joint].mass
        bodies.set_body(joint, Body(value, ratio * body.first, ratio * body.second))
