"""The table of rows of a phase: each scalar row once, with its kind, bounds, unit and expression.

``Phase.rows`` builds the table once. Printing, checks, transcription, constraint generation, refinement, violations and
replay read it. The witness does not: it evaluates the definitions of the constraints itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import Enum
from functools import cached_property

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.dynamics.rows import as_rows
from robotraj.problem.constraints.base import BoundConstraint, Row, Where


class Kind(Enum):
    """What a row is to the transcription.

    BOUND bounds one variable of the dynamics. PATH bounds an expression at the collocation points. INTEGRAL bounds an
    integral over the phase. END bounds an expression at the start or at the end.
    """

    BOUND = "bound"
    PATH = "path"
    INTEGRAL = "integral"
    END = "end"


@dataclass(frozen=True)
class PhaseRow(Row):
    """A row of a phase.

    Attributes
    ----------
    kind : Kind
    where : Where
        When it holds.
    constraint : int
        Number of its constraint in ``RowTable.constraints``.
    entry : int
        Number of the row in its constraint.
    """

    kind: Kind = Kind.PATH
    where: Where = Where.THROUGHOUT
    constraint: int = 0
    entry: int = 0


@dataclass(frozen=True, eq=False)
class RowTable(OneLine):
    """Every row that the constraints of a phase impose, in their order.

    Attributes
    ----------
    phase : str
        Name of the phase.
    body, dae : Dynamics
        The dynamics of the phase, without and with the variables that its objective adds.
    parameters : tuple of str
        Names of the parameters of the phase.
    constraints : tuple of BoundConstraint
        What the rows are made of.
    """

    phase: str
    body: Dynamics
    dae: Dynamics
    parameters: tuple[str, ...]
    constraints: tuple[BoundConstraint, ...]

    def __iter__(self) -> Iterator[PhaseRow]:
        return iter(self.rows)

    @cached_property
    def rows(self) -> tuple[PhaseRow, ...]:
        """All rows."""
        return tuple(
            PhaseRow(
                r.name,
                r.unit,
                r.lower,
                r.upper,
                r.joint,
                r.variable,
                _kind(r, constraint.where),
                constraint.where,
                c,
                i,
            )
            for c, constraint in enumerate(self.constraints)
            for i, r in enumerate(constraint.rows)
        )

    @cached_property
    def bounds(self) -> tuple[PhaseRow, ...]:
        """Rows of single variables of the dynamics, whenever they hold."""
        return self._of(Kind.BOUND)

    def _of(self, kind: Kind) -> tuple[PhaseRow, ...]:
        return tuple(row for row in self.rows if row.kind is kind)

    def values(self, rows: Sequence[PhaseRow], point: Point) -> list[ca.SX]:
        """Evaluate rows on a point of symbols; each constraint is evaluated once.

        Raises
        ------
        InputError
            An expression returns another number of values than its constraint has rows.
        """
        known: dict[int, list[ca.SX]] = {}
        for c in dict.fromkeys(row.constraint for row in rows):
            constraint = self.constraints[c]
            known[c] = as_rows(constraint.expression(point), f"expression of {constraint.name!r}")
            if len(known[c]) != len(constraint.rows):
                raise InputError(
                    f"Phase {self.phase!r}: the expression of {constraint.name!r} returns {len(known[c])} values for "
                    f"its {len(constraint.rows)} rows; it must return one for each row."
                )
        return [known[row.constraint][row.entry] for row in rows]


def _kind(row: Row, where: Where) -> Kind:
    if row.variable is not None:
        return Kind.BOUND
    if where is Where.INTEGRAL:
        return Kind.INTEGRAL
    return Kind.END if where in (Where.START, Where.END) else Kind.PATH
