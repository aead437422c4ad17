"""Friction with a slack: all contacts of a phase have the coefficient mu + s.

Rows of a contact are polynomials of mu of second degree or less, such as mu^2 f_n^2 - f_1^2 - f_2^2 >= 0. Three values
at mu, 2 mu and 3 mu give them at mu + s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import Contact, has_field
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import BoundConstraint, Constraint
from robotraj.problem.constraints.contact_limits import contact_limits
from robotraj.problem.phase import Phase
from robotraj.robot.robot import Robot
from robotraj.solution.conflict import Conflict, with_room
from robotraj.solution.phase_solution import PhaseSolution

MOST = 10.0
"""Largest coefficient of friction of the relaxed problem."""


@dataclass(frozen=True)
class RelaxedFriction(Constraint):
    """Friction of the contacts of a phase with a slack.

    Attributes
    ----------
    robot : Robot
    contacts : tuple of Contact
        The contacts that have a coefficient of friction below ``MOST``.
    name : str
        Parameter of the phase that is the slack.
    """

    robot: Robot
    contacts: tuple[Contact, ...]
    name: str
    weight: ClassVar[float] = 1.0
    """Weight of the slack in the sum."""

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Return the rows of all contacts."""
        bound = []
        for contact in self.contacts:
            mu = contact.friction
            multiples = (_with_friction(contact, k * mu).bound_to(self.robot) for k in (1.0, 2.0, 3.0))
            bound.append([contact_limits(each)[0] for each in multiples])

        def expression(point: RobotPoint) -> list[ca.SX]:
            found = []
            for contact, limits in zip(self.contacts, bound, strict=True):
                more = point.p[self.name] / contact.friction
                once, twice, thrice = (ca.vertcat(*each.expression(point)) for each in limits)
                first, second = twice - once, 0.5 * (thrice - 2.0 * twice + once)
                found += ca.vertsplit(once + more * first + more * (more - 1.0) * second)
            return found

        rows = tuple(replace(row, variable=None) for limits in bound for row in limits[0].rows)
        return BoundConstraint("friction", rows, expression)

    def conflict(self, part: PhaseSolution, slack: float) -> Conflict:
        """Return the time and the contact at which friction is exceeded most, and a coefficient that suffices."""
        table = part.phase.rows
        own = {contact.bound_to(self.robot).name: contact for contact in self.contacts}
        rows = [row for row in table.rows if row.joint in own and "friction" in row.name]
        p = np.array([part.parameters[name] for name in table.parameters])
        x, z, u = (curve(part.points) for curve in (part.trajectory.x, part.trajectory.z, part.trajectory.u))
        values = table.sample(rows, part.points, x, z, u, p)
        time, row = np.unravel_index(int(np.argmin(values)), values.shape)
        given = float(own[str(rows[row].joint)].friction)
        needed = with_room(given, given + slack)
        reason = "all contacts of the phase need it"
        return Conflict(
            part.phase.name, rows[row].label, float(part.points[time]), given, needed, "", slack, True, reason
        )


def with_free_friction(phase: Phase, name: str) -> tuple[Sequence[Contact], RelaxedFriction | None]:
    """Return the contacts of a phase with so much friction that none slips, and what relaxes theirs by a slack.

    Parameters
    ----------
    phase : Phase
    name : str
        Name of the slack.

    Returns
    -------
    contacts : sequence of Contact
    relaxed : RelaxedFriction or None
        None if no contact of the phase has a coefficient below ``MOST``.
    """
    slipping = tuple(each for each in phase.contacts if 0.0 < each.friction < MOST and has_field(each, "friction"))
    if phase.robot is None or not slipping:
        return phase.contacts, None
    contacts = [_with_friction(each, MOST) if each in slipping else each for each in phase.contacts]
    return contacts, RelaxedFriction(phase.robot, slipping, name)


def _with_friction(contact: Any, friction: float) -> Contact:
    """Return a contact with another coefficient of friction."""
    return replace(contact, friction=friction)
