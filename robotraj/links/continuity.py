"""Phases that follow each other, with or without a jump of the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

from robotraj.constraints import Row, as_bounds
from robotraj.links.base import STATE, BoundLink, Carry, Ends, Link, normal, phase_at, same_states
from robotraj.values import dataclass

if TYPE_CHECKING:
    from robotraj.problem import Phase


@dataclass(frozen=True)
class Continuity(Link):
    """Time and state run on: t and x at the end of ``first`` equal t and x at the start of ``second``."""

    first: int
    second: int

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row of time and one per state.

        Raises
        ------
        InputError
            The phases do not exist or have different states.
        """
        return _follow(phases, self.first, self.second, {}, f"Continuity({self.first}, {self.second})")


@dataclass(frozen=True)
class Jump(Link):
    """Time runs on and named states jump: x(start of second) - x(end of first) = jump.

    Parameters
    ----------
    first, second : int
    jumps : mapping of str to number, Between or None
        By state name, ``"v"`` or ``"v.elbow"``: the jump, its bounds, or None for any jump. The other states run on.
    """

    first: int
    second: int
    jumps: Mapping[str, Any] = field(default_factory=dict)

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row of time and one per state that is not free to jump."""
        return _follow(phases, self.first, self.second, self.jumps, f"Jump({self.first}, {self.second})")


def _follow(phases: Sequence[Phase], first: int, second: int, jumps: Mapping[str, Any], who: str) -> BoundLink:
    before, after = phase_at(phases, first, who), phase_at(phases, second, who)
    names = same_states(before, after, who)
    bounds = as_bounds({name: 0.0 for name in names} | dict(jumps), names, f"jumps of {who}", "state")
    kept = [i for i, (low, high) in enumerate(zip(*bounds, strict=True)) if not (low == -float("inf") and high == -low)]
    what = {i: "jump" if names[i] in jumps else "continuity" for i in kept}
    rows = (Row("continuity", "s", 0.0, 0.0, "time"),) + tuple(
        Row(what[i], before.body.states[i].unit, float(bounds.lower[i]), float(bounds.upper[i]), names[i]) for i in kept
    )

    def expression(ends: Sequence[Ends], _: Mapping[str, Any]) -> list[Any]:
        end, start = ends[0].end, ends[1].start
        return [start.t - end.t, *(start.x[names[i]] - end.x[names[i]] for i in kept)]

    pair = normal(phases, first), normal(phases, second)
    carries = () if jumps else (Carry(*pair, STATE),)
    return BoundLink(who, pair, rows, expression, carries=carries)
