"""Links: rows that join the ends of phases."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robotraj.constraints import Row
from robotraj.errors import InputError

if TYPE_CHECKING:
    from robotraj.problem import Phase


@dataclass(frozen=True)
class BoundLink:
    """A link bound to its phases.

    Attributes
    ----------
    name : str
    phases : tuple of int
        The phases whose ends it reads.
    rows : tuple of Row
    expression : callable
        ``expression(ends)`` gives len(rows) scalars; ``ends[i]`` is the pair (start, end) of points of ``phases[i]``.
    """

    name: str
    phases: tuple[int, ...]
    rows: tuple[Row, ...]
    expression: Callable[[Sequence[tuple[Any, Any]]], Sequence[Any]]


class Link(ABC):
    """A value that joins ends of phases. A new kind is one new class."""

    @abstractmethod
    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Check the phases it names and write out the rows."""


def phase_at(phases: Sequence[Phase], index: int, who: str) -> Phase:
    """The phase of that index, or an error naming the valid ones."""
    if not isinstance(index, int) or not -len(phases) <= index < len(phases):
        raise InputError(f"{who} names phase {index!r}; the problem has phases 0 to {len(phases) - 1}.")
    return phases[index]


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
        who = f"Continuity({self.first}, {self.second})"
        before, after = (phase_at(phases, i, who) for i in (self.first, self.second))
        names = [s.name for s in before.body.states]
        if names != [s.name for s in after.body.states]:
            raise InputError(
                f"{who}: phase {before.name!r} has states {names}, phase {after.name!r} has "
                f"{[s.name for s in after.body.states]}; they must be the same."
            )
        rows = (Row("continuity", "s", 0.0, 0.0, "time"),) + tuple(
            Row("continuity", s.unit, 0.0, 0.0, s.name) for s in before.body.states
        )

        def expression(ends: Sequence[tuple[Any, Any]]) -> list[Any]:
            end, start = ends[0][1], ends[1][0]
            return [start.t - end.t, *(start.x[name] - end.x[name] for name in names)]

        return BoundLink(who, (self.first % len(phases), self.second % len(phases)), rows, expression)
