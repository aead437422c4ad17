"""Links where feet land, and where feet leave the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contact_expressions import anchors, torques
from robotraj.dynamics.contacts.base import BoundContact, of_impulses
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Variable
from robotraj.problem.links.base import STATE, BoundLink, Carry, Ends, Link, check_order, normal, phase_at, same_states
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.periodic import Mirror, Periodic, Repeat, check_partners
from robotraj.problem.phase import Phase
from robotraj.problem.scalars import Scalar

IMPULSE_UNITS = {"N": "N s", "N m": "N m s"}


@dataclass(frozen=True)
class Touchdown(Link):
    """Inelastic impact: positions are continuous, velocities jump, and the contacts of ``second`` hold afterwards.

    M(q) (v+ - v-) = J(q)' L,    J(q) v+ = 0,    L in the friction cones,

    with L the impulses [N s, N m s] of the contacts of ``second``, unknowns of the link. The rows J v+ = 0 and those of
    the contact positions belong to ``second`` itself. A contact of ``first`` that ``second`` does not have leaves the
    ground at the impact without an impulse.
    Source: Hurmuzlu and Marghitu, Rigid body collisions of planar kinematic chains, Int. J. Robotics Research 13
    (1994).

    Parameters
    ----------
    first, second : int
        The phases before and after. For a gait that repeats, ``first`` is its last phase and ``second`` its first.
    repeat : Periodic or Mirror, optional
        Displacement or reflection between the end of ``first`` and the start of ``second``; its own ``first`` and
        ``last`` are not used. Without it, time is continuous as well.
    """

    first: int
    second: int
    repeat: Periodic | Mirror | None = None

    def without_numbers(self) -> Touchdown:
        """Return the link with displacements of zero."""
        return self if self.repeat is None else replace(self, repeat=self.repeat.without_numbers())

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write rows of time, positions, momentum and cones.

        Raises
        ------
        InputError
            A phase does not exist or has other states, ``second`` has no contact, or a mirror names no partner of a
            contact.
        """
        what = f"Touchdown({self.first}, {self.second})"
        before, after = phase_at(phases, self.first, what), phase_at(phases, self.second, what)
        if self.repeat is None:
            check_order(phases, self.first, self.second, what)
        names = same_states(before, after, what)
        body = after.body
        if not isinstance(body, RigidBody) or not body.contacts:
            raise InputError(f"{what}: phase {after.name!r} holds no contact; give it contacts=[rt.PointContact(...)].")
        nq, robot = body.robot.nq, body.robot
        repeat = self.repeat.of(before, names, what) if self.repeat is not None else Repeat.same(names)
        for phase in (before, after):
            check_partners(repeat, phase)
        placed = [i for i in repeat.bounded if i < nq]
        if self.repeat is not None:
            fast = sorted(set(self.repeat.displacement) & set(names[nq:]))
            if fast:
                raise InputError(f"{what}: {fast[0]!r} follows from the impact; remove its displacement.")
        rows = [] if self.repeat is not None else [Row("continuity", "s", 0.0, 0.0, "time")]
        rows += [Row("continuity", body.states[i].unit, repeat.lower[i], repeat.upper[i], names[i]) for i in placed]
        rows += [
            Row("impact", "N m s" if unit == "rad" else "N s", 0.0, 0.0, name)
            for name, unit in zip(robot.velocity_names, robot.units, strict=True)
        ]
        for contact in body.contacts:
            rows += [
                Row(f"impulse {r.name}", IMPULSE_UNITS.get(r.unit, r.unit), r.lower, r.upper, r.joint)
                for r in map(of_impulses, contact.limit_rows)
                if r is not None
            ]
        timed = self.repeat is None

        def expression(ends: Sequence[Ends], impulses: Mapping[str, Scalar]) -> list[Scalar]:
            end, start = ends[0].end, cast(RobotPoint, ends[1].start)
            image = repeat.image(end)
            values: list[Scalar] = [start.t - end.t] if timed else []
            values += [start.x[names[i]] - image[i] for i in placed]
            jump = ca.vertcat(*(start.x[name] - value for name, value in zip(names[nq:], image[nq:], strict=True)))
            momentum = ca.mtimes(start.symbolic.mass_matrix(start.q), jump)
            limits: list[Scalar] = []
            for contact in body.contacts:
                own = [impulses[name] for name in impulse_names(contact)]
                momentum -= torques(contact, start, own)
                values_of = contact.limits(start, own, anchors(contact, start.p))
                limits += [v for v, r in zip(values_of, contact.limit_rows, strict=True) if of_impulses(r)]
            return [*values, *ca.vertsplit(momentum), *limits]

        pair = normal(phases, self.first), normal(phases, self.second)
        unknowns = tuple(
            Variable(name, IMPULSE_UNITS.get(force.unit, force.unit), "impulse", f"{contact.name} {axis_of(force)}")
            for contact in body.contacts
            for name, force in zip(impulse_names(contact), contact.forces, strict=True)
        )
        # Velocities jump. With a vertical displacement, contact positions do not carry over either.
        kept = STATE - {"contact velocity"} if repeat.level else frozenset({"unit quaternion"})
        carries = (Carry(*pair, kept, repeat.partners),)
        return BoundLink(what, pair, tuple(rows), expression, unknowns, carries)


def impulse_names(contact: BoundContact) -> list[str]:
    """Names of the impulses of a contact, ``impulse.<contact>.<axis>``."""
    return [f"impulse.{contact.name}.{axis_of(force)}" for force in contact.forces]


def axis_of(force: Variable) -> str:
    """Axis of a contact force, the last part of its name."""
    return force.name.rsplit(".", 1)[-1]


@dataclass(frozen=True)
class Liftoff(Link):
    """Contacts of ``first`` end: time and state are continuous, and ``second`` has fewer contacts.

    Parameters
    ----------
    first, second : int
        The phases before and after.
    """

    first: int
    second: int

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write the rows of ``Continuity``.

        Raises
        ------
        InputError
            ``second`` has all contacts of ``first``, or a new one.
        """
        what = f"Liftoff({self.first}, {self.second})"
        held, kept = (
            {contact.name for contact in phase_at(phases, i, what).bound_contacts} for i in (self.first, self.second)
        )
        if not kept < held:
            raise InputError(
                f"{what}: the first phase has the contacts {sorted(held)}, the second {sorted(kept)}; at a liftoff "
                "contacts end and none begins. Use rt.Touchdown if a foot lands, rt.Continuity if all contacts stay."
            )
        return replace(Continuity(self.first, self.second).bind(phases), name=what)
