"""The mass of a body as a parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies, Body
from robotraj.dynamics.design.quantity import Quantity, body_of_name
from robotraj.dynamics.variable import Scalar

if TYPE_CHECKING:
    from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class BodyMass(Quantity):
    """The parameter m is the mass of a body [kg]; its shape stays, its density changes.

    With m0 the URDF's mass: h = (m/m0) h0 and I = (m/m0) I0 about every point, so the centre of mass stays.

    Parameters
    ----------
    body : str
        A link, or the joint that moves it. The body is everything that moves rigidly with that joint, links
        behind fixed or locked joints included.
    """

    body: str
    what = "mass of body"

    @property
    def whose(self) -> str:
        """Name of the body."""
        return self.body

    def unit(self, robot: Robot) -> str:
        """Kilograms."""
        return "kg"

    def check(self, robot: Robot) -> tuple[object, ...]:
        """Refuse bodies that do not move or have no mass to scale."""
        joint = body_of_name(robot, self.body, "rt.design.BodyMass")
        if not robot.model.inertias[joint].mass > 0:
            raise InputError(
                f"rt.design.BodyMass: body {self.body!r} has no mass in the URDF, so no shape to scale; "
                "add one with rt.design.Payload(frame)."
            )
        return BodyMass, joint

    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Scale all moments by m/m0."""
        joint = body_of_name(bodies.robot, self.body, "rt.design.BodyMass")
        body = bodies.body(joint)
        ratio = value / bodies.robot.model.inertias[joint].mass
        bodies.set_body(joint, Body(value, ratio * body.first, ratio * body.second))
