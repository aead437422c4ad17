"""A robot without dynamics: a double integrator of its joints, without masses or torques."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, refuse_contacts
from robotraj.dynamics.design.binding import Design
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.variable import Named, Variable
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class KinematicBody(RigidBody):
    """x = (q, v), u = a; f = (v, a). Points have no torques."""

    algebraic: tuple[Variable, ...] = ()
    residuals: tuple[Variable, ...] = ()

    @cached_property
    def controls(self) -> tuple[Variable, ...]:
        """Accelerations ``a.<joint>``."""
        return self._accelerations

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> RobotPoint:
        """Wrap columns of symbols as a RobotPoint; accelerations have the names that they have in the other forms."""
        nq = self.robot.nq
        accelerations = self._names["algebraic variable"] if u is not None else []
        return RobotPoint(
            t,
            Named("state", self._names["state"], x),
            Named("algebraic variable", accelerations, u),
            Named("control", accelerations, u),
            Named("parameter", names, p),
            self.robot,
            x[:nq],
            x[nq:],
            u,
            None,
            *self._numbers(p, names),
        )

    def residual(self, point: RobotPoint) -> ca.SX:
        """No algebraic rows."""
        return ca.SX(0, 1)


@dataclass(frozen=True)
class Kinematics:
    """Choose no dynamics: joints accelerate freely within their limits."""

    def of(self, robot: Robot, design: Design | None = None, contacts: Sequence[BoundContact] = ()) -> KinematicBody:
        """Bind to a robot; only the lengths of a design have an effect.

        Raises
        ------
        InputError
            Contacts: without dynamics there are no forces.
        """
        refuse_contacts(contacts, "Kinematics")
        return KinematicBody(robot, design)
