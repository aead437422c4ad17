"""Terms that contacts add to a robot's DAE: held rows, directions of the state's corrections, joint torques."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.point import ContactTerms, RobotPoint
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot

ROOT_FREEDOMS = {"fixed": (0, 0), "planar": (2, 3), "floating": (3, 6)}
"""How many of the first velocities of a root translate, and how many there are."""


@dataclass(frozen=True, eq=False)
class ContactExpressions:
    """The terms of one contact at a point; each part is built when first read."""

    contact: BoundContact
    point: RobotPoint

    @cached_property
    def reaction(self) -> ca.SX:
        """Generalised force -J' f of the contact in the torque balance, (nv,) [N m, N]."""
        return -torques(self.contact, self.point, [self.point.z[force.name] for force in self.contact.forces])

    @cached_property
    def places(self) -> Sequence[Scalar]:
        """Position rows, zero while the contact is at its anchors [m, rad]."""
        return self.contact.position(self.point, anchors(self.contact, self.point.p))

    @cached_property
    def rates(self) -> Sequence[Scalar]:
        """Velocities [m/s, rad/s]."""
        return self.contact.velocity(self.point)

    @cached_property
    def accelerations(self) -> Sequence[Scalar]:
        """Accelerations [m/s^2, rad/s^2]."""
        return self.contact.acceleration(self.point)


def contact_terms_of(contact: BoundContact, point: RobotPoint) -> ContactTerms:
    """Return a contact's terms: symbols where they are separate functions (``contact_terms``), else expressions."""
    return point.contact_terms.get(contact.name) or ContactExpressions(contact, point)


def hold(contacts: Sequence[BoundContact], point: RobotPoint) -> list[Scalar]:
    """Rows that are zero while the contacts hold: all places, then all velocities."""
    terms = [contact_terms_of(contact, point) for contact in contacts]
    return [row for each in terms for row in each.places] + [row for each in terms for row in each.rates]


def anchors(contact: BoundContact, p: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return a contact's anchors by name from the parameters of a phase."""
    return {anchor.name: p[anchor.name] for anchor in contact.anchors}


def torques(contact: BoundContact, point: RobotPoint, forces: Sequence[Scalar]) -> ca.SX:
    """Joint torques J' f of a contact's forces, (nv,) [N m, N]."""
    total = ca.SX.zeros(point.robot.nv)
    for frame, wrench in contact.wrench(point, forces):
        total += ca.mtimes(point.symbolic.frame_jacobian(frame)(point.q).T, ca.vertcat(*wrench))
    return total


def pinned(robot: Robot, contacts: Sequence[BoundContact]) -> bool:
    """Whether corrections move only the root: the robot has one contact with as many rows as root freedoms."""
    return len(contacts) == 1 and bool(contacts[0].anchors) and len(contacts[0].holds) in ROOT_FREEDOMS[robot.root]


def correct(contacts: Sequence[BoundContact], point: RobotPoint, c: ca.SX) -> ca.SX:
    """Tangent vector (nv,) along which one correction c for each held row moves the robot.

    A single contact is corrected by a motion of the root: a translation for a point contact, a translation and a
    rotation for a foot. The robot then moves as if pinned at the contact, and the joints have the polynomials of a
    model with a fixed root. Several contacts, and contacts of a robot with a fixed root, are corrected along J' c
    (Posa, Kuindersma and Tedrake, ICRA 2016).
    """
    robot, nv = point.robot, point.robot.nv
    if not contacts:
        return ca.SX.zeros(nv)
    if pinned(robot, contacts):
        return ca.vertcat(c, ca.SX.zeros(nv - c.numel()))
    return transposed_jacobian_product(contacts, point, c)


def transposed_jacobian_product(contacts: Sequence[BoundContact], point: RobotPoint, c: ca.SX) -> ca.SX:
    """J' c, (nv,), for the velocity rows J v of contacts."""
    # The gradient of J v by v is J, whatever v is.
    v = ca.SX.sym("v", point.robot.nv)
    at_speed = RobotPoint(
        point.t, point.x, point.z, point.u, point.p, point.robot, point.q, v, None, None, point.symbolic, point.damping
    )
    rows = ca.vertcat(*(row for contact in contacts for row in contact.velocity(at_speed)))
    return ca.jtimes(rows, v, c, True)
