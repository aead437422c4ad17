"""Feet that come down, and feet that leave the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import of_impulses
from robotraj.dynamics.holding import anchors, torques
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Variable
from robotraj.problem.links.base import STATE, BoundLink, Carry, Ends, Link, check_order, normal, phase_at, same_states
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.periodic import Mirror, Periodic, Repeat, check_partners

if TYPE_CHECKING:
    from robotraj.dynamics.contacts.base import BoundContact
    from robotraj.problem.phase import Phase
    from robotraj.problem.scalars import Scalar

IMPULSE_UNITS = {"N": "N s", "N m": "N m s"}


@dataclass(frozen=True)
class Touchdown(Link):
    """Inelastic impact: positions run on, velocities jump, and what ``second`` holds stands still from then on.

    M(q) (v+ - v-) = J(q)' L,    J(q) v+ = 0,    L in the friction cones,

    with L the impulses [N s, N m s] of the contacts of ``second``, unknowns of the link. The rows J v+ = 0, and that
    the feet stand on the ground, are those of ``second`` itself. A contact that ``first`` holds and ``second`` does not
    leaves the ground at the impact without an impulse.
    Source: Hurmuzlu and Marghitu, Rigid body collisions of planar kinematic chains, Int. J. Robotics Research 13
    (1994).

    Parameters
    ----------
    first, second : int
        The phases before and after. A gait that closes on itself names its last phase first and says by ``repeat``
        how.
    repeat : Periodic or Mirror, optional
        How the start of ``second`` sees the end of ``first``: displaced, or left and right swapped; its own ``first``
        and ``last`` are not read. Without it, time runs on as well.
    """

    first: int
    second: int
    repeat: Periodic | Mirror | None = None

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write rows of time, positions, momentum and cones.

        Raises
        ------
        InputError
            Phases that do not exist, have other states, or where ``second`` holds no contact; a mirror that says of no
            partner which contact it is.
        """
        who = f"Touchdown({self.first}, {self.second})"
        before, after = phase_at(phases, self.first, who), phase_at(phases, self.second, who)
        if self.repeat is None:
            check_order(phases, self.first, self.second, who)
        names = same_states(before, after, who)
        body = after.body
        if not isinstance(body, RigidBody) or not body.contacts:
            raise InputError(f"{who}: phase {after.name!r} holds no contact; give it contacts=[rt.PointContact(...)].")
        nq, robot = body.robot.nq, body.robot
        repeat = self.repeat.of(before, names, who) if self.repeat is not None else Repeat.same(names)
        for phase in (before, after):
            check_partners(repeat, phase)
        placed = [i for i in repeat.bounded if i < nq]
        if self.repeat is not None:
            fast = sorted(set(self.repeat.displacement) & set(names[nq:]))
            if fast:
                raise InputError(f"{who}: {fast[0]!r} follows from the impact; remove its displacement.")
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
        # Velocities jump; and where the motion climbs, no foot stands where it stood.
        kept = STATE - {"contact velocity"} if repeat.level else frozenset({"unit quaternion"})
        carries = (Carry(*pair, kept, repeat.partners),)
        return BoundLink(who, pair, tuple(rows), expression, unknowns, carries)


def impulse_names(contact: BoundContact) -> list[str]:
    """Names of the impulses of a contact, ``impulse.<contact>.<axis>``."""
    return [f"impulse.{contact.name}.{axis_of(force)}" for force in contact.forces]


def axis_of(force: Variable) -> str:
    """Axis of a contact force, the last part of its name."""
    return force.name.rsplit(".", 1)[-1]


@dataclass(frozen=True)
class Liftoff(Link):
    """Contacts of ``first`` are let go: time and state run on into ``second``, which holds fewer.

    Parameters
    ----------
    first, second : int
    """

    first: int
    second: int

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write the rows of ``Continuity``.

        Raises
        ------
        InputError
            ``second`` holds all that ``first`` held, or takes hold of something: that is a ``Touchdown``.
        """
        who = f"Liftoff({self.first}, {self.second})"
        held, kept = (
            {contact.name for contact in phase_at(phases, i, who).bound_contacts} for i in (self.first, self.second)
        )
        if not kept < held:
            raise InputError(
                f"{who}: the first phase holds {sorted(held)}, the second {sorted(kept)}; at a liftoff contacts "
                "are let go and none is made. Use rt.Touchdown where a foot comes down, rt.Continuity where all stays."
            )
        return replace(Continuity(self.first, self.second).bind(phases), name=who)
