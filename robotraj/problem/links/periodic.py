"""Links of motions that repeat, with a displacement or mirrored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.point import Point
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.bounds import Interval, as_bounds
from robotraj.problem.links.base import STATE, BoundLink, Carry, Ends, Link, normal, phase_at, same_states
from robotraj.problem.links.limited_rates import joined_rates
from robotraj.problem.phase import Phase
from robotraj.problem.scalars import Scalar

ALONG_THE_GROUND = {"q.root_x", "q.root_y"}
"""Displacements along level ground, after which contact positions still hold."""


@dataclass(frozen=True, eq=False)
class Repeat(OneLine):
    """The relation of the start of a motion to its end: lower <= x_start - image(x_end) <= upper.

    Attributes
    ----------
    names : list of str
        Names of the states.
    sources : list of (str, float)
        For every state, the state of the end whose image it is, and the sign.
    lower, upper : list of float
        Bounds that follow from the displacement.
    partners : mapping of str to str
        Contacts and joints that change places.
    level : bool
        Whether the displacement is along level ground.
    """

    names: list[str]
    sources: list[tuple[str, float]]
    lower: list[float]
    upper: list[float]
    partners: Mapping[str, str]
    level: bool

    @staticmethod
    def same(names: list[str]) -> Repeat:
        """Return the start that equals the end."""
        zeros = [0.0] * len(names)
        return Repeat(names, [(name, 1.0) for name in names], zeros, zeros, {}, True)

    @property
    def bounded(self) -> list[int]:
        """States whose displacement is not free."""
        return [i for i in range(len(self.names)) if np.isfinite(self.lower[i]) or np.isfinite(self.upper[i])]

    def image(self, point: Point) -> list[Scalar]:
        """Return the images of the states of a point, in the order of ``names``."""
        return [sign * point.x[name] for name, sign in self.sources]


@dataclass(frozen=True)
class Periodic(Link):
    """The motion repeats: x(end of last) - x(start of first) = displacement.

    Parameters
    ----------
    displacement : mapping of str to number, Between or None
        Increments in a period by state name, ``{"q.root_x": rt.between(0.3, 1)}``; None leaves one free. The other
        states repeat exactly.
    first, last : int
        The first and the last phase of the period; by default those of the problem.
    """

    displacement: Mapping[str, Interval] = field(default_factory=dict)
    first: int = 0
    last: int = -1

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row per state whose gain is bounded."""
        return _repeat(self, phases, "Periodic")

    def without_numbers(self) -> Periodic:
        """Return the link with displacements of zero."""
        return replace(self, displacement=dict.fromkeys(self.displacement, 0.0))

    def of(self, phase: Phase, names: list[str], what: str) -> Repeat:
        """Read the displacement; every state is its own image."""
        return _displaced(names, [(name, 1.0) for name in names], self.displacement, {}, what)


@dataclass(frozen=True)
class Mirror(Link):
    """The motion ends in the mirror image of its start: half a symmetric gait.

    For each state s with partner m(s):  x_s(end of last) - sign_s x_m(s)(start of first) = displacement_s.

    Parameters
    ----------
    partners : mapping of str to str
        Pairs of joints (states of a System) or of contacts that change places, each given once. Others are their own
        partners.
    negated : sequence of str
        Joints (states) whose sign changes in the mirror, such as roll and yaw.
    displacement : mapping of str to number, Between or None
        Increments by state name, as for ``Periodic``.
    first, last : int
        As for ``Periodic``.
    """

    partners: Mapping[str, str] = field(default_factory=dict)
    negated: Sequence[str] = ()
    displacement: Mapping[str, Interval] = field(default_factory=dict)
    first: int = 0
    last: int = -1

    @property
    def partner_of(self) -> dict[str, str]:
        """Partner of every name in ``partners``, in both directions."""
        return {**self.partners, **{b: a for a, b in self.partners.items()}}

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row per state whose gain is bounded."""
        return _repeat(self, phases, "Mirror")

    def without_numbers(self) -> Mirror:
        """Return the link with displacements of zero."""
        return replace(self, displacement=dict.fromkeys(self.displacement, 0.0))

    def of(self, phase: Phase, names: list[str], what: str) -> Repeat:
        """Pair the states of both sides.

        Raises
        ------
        InputError
            A name is neither that of a joint nor that of a contact.
        """
        states = phase.body.states
        labels = list(dict.fromkeys(s.label for s in states))
        contacts = [contact.name for contact in phase.bound_contacts]
        both = self.partner_of
        for name in self.negated:
            if name not in labels:
                raise unknown_name("joint", name, labels, "Mirror(negated=...) names joints.")
        # A pair of contacts may be given although the phase has only one of them.
        feet = {name for pair in self.partners.items() if set(pair) & set(contacts) for name in pair}
        for name in both:
            if name not in labels and name not in feet and not _is_frame(phase, name):
                raise unknown_name("joint", name, labels, "Mirror(partners=...) names joints or contacts.")
        by_kind = {(s.quantity, s.label): s.name for s in states}
        # Solved for the start, with the sign of the partner: x_m(s)(end) = sign_m(s) x_s(start).
        images = [(s.quantity, both.get(s.label, s.label)) for s in states]
        sources = [(by_kind[image], -1.0 if image[1] in self.negated else 1.0) for image in images]
        return _displaced(names, sources, self.displacement, both, what)


def check_partners(repeat: Repeat, phase: Phase) -> None:
    """Refuse contacts without a partner on limbs that change places, since the next standing foot would be unknown.

    Raises
    ------
    InputError
        A contact of the phase has no partner.
    """
    robot = phase.robot
    if robot is None:
        return
    model = robot.model
    for contact in phase.bound_contacts:
        above = [model.names[i] for i in model.supports[model.frames[robot.frame(contact.frame)].parentJoint]]
        swapped = [name for name in above if repeat.partners.get(name, name) != name]
        if swapped and contact.name not in repeat.partners:
            joint, other = swapped[-1], repeat.partners[swapped[-1]]
            raise InputError(
                f"Mirror swaps {joint!r}, which carries contact {contact.name!r}, with {other!r}; name the contact's "
                f"partner as well: partners={{..., {contact.name!r}: <the contact on the side of {other!r}>}}."
            )


def _is_frame(phase: Phase, name: str) -> bool:
    return phase.robot is not None and name in phase.robot.frame_names


def _displaced(
    names: list[str],
    sources: list[tuple[str, float]],
    displacement: Mapping[str, Interval],
    partners: Mapping[str, str],
    what: str,
) -> Repeat:
    if not isinstance(displacement, Mapping):
        raise InputError(
            f"displacement of {what} must map names of states to their increments, such as {{{names[0]!r}: 1.0}}; "
            f"got {displacement!r}. Phases are named by first= and last=."
        )
    bounds = as_bounds({name: 0.0 for name in names} | dict(displacement), names, f"displacement of {what}", "state")
    at = {name: i for i, name in enumerate(names)}
    # x_end,m - sign x_start,s = d_m is x_start,s - sign x_end,m = - sign d_m.
    ranges = [
        (-bounds.upper[at[source]], -bounds.lower[at[source]])
        if sign > 0
        else (bounds.lower[at[source]], bounds.upper[at[source]])
        for source, sign in sources
    ]
    lower, upper = ([float(pair[side]) for pair in ranges] for side in (0, 1))
    return Repeat(names, sources, lower, upper, partners, set(displacement) <= ALONG_THE_GROUND)


def _repeat(link: Periodic | Mirror, phases: Sequence[Phase], what: str) -> BoundLink:
    opening, closing = phase_at(phases, link.first, what), phase_at(phases, link.last, what)
    names = same_states(opening, closing, what)
    repeat = link.of(closing, names, what)
    for phase in (opening, closing):
        check_partners(repeat, phase)
    kept = repeat.bounded
    if not kept:
        raise InputError(f"{what} leaves every state free; bound the displacement of at least one.")
    rows = tuple(
        Row(what.lower(), opening.body.states[i].unit, repeat.lower[i], repeat.upper[i], names[i]) for i in kept
    )

    def expression(ends: Sequence[Ends], _: Mapping[str, Scalar]) -> list[Scalar]:
        image = repeat.image(ends[1].end)
        return [ends[0].start.x[names[i]] - image[i] for i in kept]

    pair = normal(phases, link.first), normal(phases, link.last)
    level = STATE if repeat.level else frozenset({"unit quaternion"})
    bound = BoundLink(what, pair, rows, expression, carries=(Carry(pair[1], pair[0], level, repeat.partners),))
    # Where speeds repeat, so do accelerations.
    images = {
        names[i].removeprefix("v."): (source.removeprefix("v."), sign)
        for i, (source, sign) in enumerate(repeat.sources)
        if names[i].startswith("v.") and repeat.lower[i] == repeat.upper[i] == 0.0
    }
    return bound.with_rates(joined_rates(closing, opening, images), 1, 0)
