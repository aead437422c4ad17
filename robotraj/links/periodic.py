"""Motions that repeat, as they are or mirrored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj.constraints import Row, as_bounds
from robotraj.errors import InputError, unknown_name
from robotraj.links.base import BoundLink, Ends, Link, normal, phase_at, same_states

if TYPE_CHECKING:
    from robotraj.problem import Phase


@dataclass(frozen=True)
class Periodic(Link):
    """The motion ends as it began: x(end of last) - x(start of first) = displacement.

    Parameters
    ----------
    displacement : mapping of str to number, Between or None
        By state name: what the motion gains in a period (``{"q.x": rt.between(0.3, 1)}``, None for anything); the other
        states repeat exactly.
    first, last : int
        The phases that open and close the period; all of the problem by default.
    """

    displacement: Mapping[str, Any] = field(default_factory=dict)
    first: int = 0
    last: int = -1

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row per state whose gain is bounded."""
        return _repeat(phases, self.first, self.last, self.displacement, {}, "Periodic")


@dataclass(frozen=True)
class Mirror(Link):
    """The motion ends as the mirror image of how it began: half a symmetric gait.

    For each state s with partner m(s):  x_s(end of last) - sign_s x_m(s)(start of first) = displacement_s.

    Parameters
    ----------
    partners : mapping of str to str
        Pairs of joints (of states, for a System) that change places, each written once. Joints not named are their own
        partners.
    negated : sequence of str
        Joints (states) whose sign changes in the mirror, as roll and yaw do.
    displacement : mapping of str to number, Between or None
        By state name, as for ``Periodic``.
    first, last : int
    """

    partners: Mapping[str, str] = field(default_factory=dict)
    negated: Sequence[str] = ()
    displacement: Mapping[str, Any] = field(default_factory=dict)
    first: int = 0
    last: int = -1

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row per state whose gain is bounded."""
        states = phase_at(phases, self.first, "Mirror").body.states
        labels = list(dict.fromkeys(s.label for s in states))
        both = {**self.partners, **{b: a for a, b in self.partners.items()}}
        for name in (*both, *self.negated):
            if name not in labels:
                raise unknown_name("joint", name, labels, "Mirror(partners=..., negated=...) names joints.")
        names = {(s.quantity, s.label): s.name for s in states}
        images = {
            s.name: (names[s.quantity, both.get(s.label, s.label)], -1.0 if s.label in self.negated else 1.0)
            for s in states
        }
        return _repeat(phases, self.first, self.last, self.displacement, images, "Mirror")


def _repeat(
    phases: Sequence[Phase],
    first: int,
    last: int,
    displacement: Mapping[str, Any],
    images: Mapping[str, tuple[str, float]],
    who: str,
) -> BoundLink:
    opening, closing = phase_at(phases, first, who), phase_at(phases, last, who)
    names = same_states(opening, closing, who)
    bounds = as_bounds({name: 0.0 for name in names} | dict(displacement), names, f"displacement of {who}", "state")
    kept = [i for i in range(len(names)) if np.isfinite(bounds.lower[i]) or np.isfinite(bounds.upper[i])]
    if not kept:
        raise InputError(f"{who} leaves every state free.")
    rows = tuple(
        Row(who.lower(), opening.body.states[i].unit, float(bounds.lower[i]), float(bounds.upper[i]), names[i])
        for i in kept
    )

    def expression(ends: Sequence[Ends]) -> list[Any]:
        start, end = ends[0].start, ends[1].end
        values = []
        for i in kept:
            image, sign = images.get(names[i], (names[i], 1.0))
            values.append(end.x[names[i]] - sign * start.x[image])
        return values

    return BoundLink(who, (normal(phases, first), normal(phases, last)), rows, expression)
