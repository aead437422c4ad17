"""Limits of a contact as constraints: unilateral force, friction cone, centre of pressure, foothold."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.dynamics.contact_expressions import anchors
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import BoundConstraint, Where
from robotraj.problem.scalars import Scalar


def contact_limits(contact: BoundContact) -> tuple[BoundConstraint, BoundConstraint]:
    """Rows of a contact: on its force, at every collocation point, and on its foothold, which is constant."""

    def expression(point: RobotPoint) -> Sequence[Scalar]:
        forces = [point.z[force.name] for force in contact.forces]
        return contact.limits(point, forces, anchors(contact, point.p))

    def footing(point: RobotPoint) -> Sequence[Scalar]:
        return contact.footing(anchors(contact, point.p))

    return (
        BoundConstraint(f"contact {contact.name}", contact.limit_rows, expression),
        BoundConstraint(f"foothold {contact.name}", contact.footing_rows, footing, Where.START),
    )
