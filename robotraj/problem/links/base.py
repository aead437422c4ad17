"""The base class of links: rows on the ends of phases."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from typing import NamedTuple, TypeAlias

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass, own_fields
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.point import Point
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import free_of
from robotraj.problem.phase import Phase
from robotraj.problem.scalars import Scalar


class Ends(NamedTuple):
    """The points at both ends of a phase; they have ``t``, ``x``, ``p`` and, for robots, ``q``, ``v`` and frames."""

    start: Point
    end: Point


@dataclass(frozen=True)
class Carry(OneLine):
    """Invariants that hold at the start of a phase because they hold at the end of another.

    Attributes
    ----------
    source, target : int
        The phase that ends and the phase that starts.
    quantities : frozenset of str
        Quantities of the invariants: ``"contact position"`` ...
    partners : mapping of str to str
        Contact of the source by contact of the target; by default those with equal names.
    """

    source: int
    target: int
    quantities: frozenset[str]
    partners: Mapping[str, str] = field(default_factory=dict)


Joined: TypeAlias = "list[tuple[Row, Callable[[Point, Point], Scalar]]]"
"""Rows, with the differences that are 0 of points at the end of a phase and at the start of the next one."""

STATE = frozenset({"unit quaternion", "contact position", "contact velocity"})
"""Invariants that hold on both sides of a link with a continuous state."""


@dataclass(frozen=True, eq=False)
class BoundLink(OneLine):
    """A link bound to its phases.

    Attributes
    ----------
    name : str
    phases : tuple of int
        The phases whose ends the expression depends on.
    rows : tuple of Row
    expression : callable
        ``expression(ends, unknowns)`` gives len(rows) scalars; ``ends[i]`` are the ends of ``phases[i]`` and
        ``unknowns`` maps the names of the link's unknowns to their values.
    unknowns : tuple of Variable
        Unknowns of the link itself, such as the impulses of an impact.
    carries : tuple of Carry
        Invariants that need not be imposed again.
    """

    name: str
    phases: tuple[int, ...]
    rows: tuple[Row, ...]
    expression: Callable[[Sequence[Ends], Mapping[str, Scalar]], Sequence[Scalar]]
    unknowns: tuple[Variable, ...] = ()
    carries: tuple[Carry, ...] = ()

    def with_rates(self, joined: Joined, first: int, second: int) -> BoundLink:
        """Append rows between the end of one of the phases and the start of another, numbered as in ``phases``."""
        if not joined:
            return self
        own = self.expression

        def expression(ends: Sequence[Ends], unknowns: Mapping[str, Scalar]) -> list[Scalar]:
            end, start = ends[first].end, ends[second].start
            return [*own(ends, unknowns), *(difference(end, start) for _, difference in joined)]

        return replace(self, rows=(*self.rows, *(row for row, _ in joined)), expression=expression)

    def values(self, ends: Sequence[Ends], unknowns: Mapping[str, Scalar]) -> list[ca.SX]:
        """Evaluate the expression on ends and unknowns of symbols, as a list of scalars."""
        return as_rows(self.expression(ends, unknowns), f"expression of {self.name}")


class Link(OneLine, ABC):
    """A value that joins ends of phases. A new kind is one new class."""

    def __post_init__(self) -> None:
        """Keep copies of the arrays, lists and mappings that were given."""
        own_fields(self)

    @abstractmethod
    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Check the named phases and return the rows."""

    def without_numbers(self) -> Link:
        """Return the link without the numbers that are bounds of its rows and enter no expression."""
        return self


def phase_at(phases: Sequence[Phase], index: int, what: str) -> Phase:
    """Return the phase of an index.

    Raises
    ------
    InputError
        There is no such phase.
    """
    if not isinstance(index, int) or not -len(phases) <= index < len(phases):
        have = f"the problem has phases 0 to {len(phases) - 1}"
        raise InputError(f"{what} names phase {index!r}; {have}. Give the number of a phase.")
    return phases[index]


def normal(phases: Sequence[Phase], index: int) -> int:
    """Return the nonnegative index of a phase; -1 is the last one."""
    return index % len(phases)


def check_order(phases: Sequence[Phase], first: int, second: int, what: str) -> None:
    """Refuse continuity of time from a phase into itself or an earlier one."""
    if normal(phases, second) <= normal(phases, first):
        raise InputError(
            f"{what}: the second phase must be later than the first. Close a motion that repeats by rt.Periodic(...), "
            "rt.Mirror(...) or rt.Touchdown(last, 0, repeat=...)."
        )


def state_names(phase: Phase) -> list[str]:
    """Names of the states of a phase; on a path, of the positions and velocities of its joints."""
    return [state.name for state in free_of(phase.body).states]


def same_states(before: Phase, after: Phase, what: str) -> list[str]:
    """Return the names of the states of two phases, and check that they are equal."""
    names = state_names(before)
    if names != state_names(after):
        raise InputError(
            f"{what}: phase {before.name!r} has states {names}, phase {after.name!r} has {state_names(after)}; "
            "they must be the same."
        )
    return names
