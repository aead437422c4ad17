"""What contacts add to a robot's DAE: held rows, directions in which the state is corrected, and joint torques."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import casadi as ca

from robotraj.dynamics.point import RobotPoint

if TYPE_CHECKING:
    from robotraj.contacts import BoundContact
    from robotraj.robot import Robot

ROOT_FREEDOMS = {"fixed": (0, 0), "planar": (2, 3), "floating": (3, 6)}
"""How many of the first velocities of a root translate, and how many there are."""


def hold(contacts: Sequence[BoundContact], point: RobotPoint) -> list[Any]:
    """Rows that are zero while the contacts hold: all places, then all velocities."""
    places = [row for contact in contacts for row in contact.position(point, anchors(contact, point.p))]
    return places + [row for contact in contacts for row in contact.velocity(point)]


def anchors(contact: BoundContact, p: Any) -> dict[str, Any]:
    """Where a contact stands, by anchor name, out of the parameters of a phase."""
    return {anchor.name: p[anchor.name] for anchor in contact.anchors}


def torques(contact: BoundContact, point: RobotPoint, forces: Sequence[Any]) -> Any:
    """Joint torques J' f of a contact's forces, (nv,) [N m, N]."""
    total = ca.SX.zeros(point.robot.nv)
    for frame, wrench in contact.wrench(point, forces):
        total += ca.mtimes(point.symbolic.frame_jacobian(frame)(point.q).T, ca.vertcat(*wrench))
    return total


def correct(robot: Robot, contacts: Sequence[BoundContact], point: RobotPoint, c: Any) -> Any:
    """Tangent vector (nv,) along which one correction c for each held row moves the robot.

    One contact is corrected by the root: a point by its translation, a foot by all of it. The robot then moves as if
    it were pinned there, and the polynomials of its joints are those of a model without a root. More contacts, and
    those of a robot that stands fixed, are corrected along J' c (Posa, Kuindersma and Tedrake, ICRA 2016).
    """
    nv = robot.nv
    if not contacts:
        return ca.SX.zeros(nv)
    if len(contacts) == 1 and contacts[0].anchors and c.numel() in ROOT_FREEDOMS[robot.root]:
        return ca.vertcat(c, ca.SX.zeros(nv - c.numel()))
    # The velocity rows are J v: their gradient by v is J, whatever v is.
    v = ca.SX.sym("v", nv)
    at_speed = RobotPoint(
        point.t, point.x, point.z, point.u, point.p, robot, point.q, v, None, None, point.symbolic, point.damping
    )
    rows = ca.vertcat(*(row for contact in contacts for row in contact.velocity(at_speed)))
    return ca.jtimes(rows, v, c, True)
