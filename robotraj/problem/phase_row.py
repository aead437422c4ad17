"""One scalar row of a phase: its kind, when it applies, bounds and unit."""

from __future__ import annotations

from enum import Enum

from robotraj._util.values import dataclass
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import Where


class Kind(Enum):
    """Kind of a row, which determines how the transcription imposes it.

    BOUND bounds one variable of the dynamics. PATH bounds an expression at the collocation points. INTEGRAL bounds an
    integral over the phase. END bounds an expression at the start or at the end. RATE bounds the time derivative of one
    variable.
    """

    BOUND = "bound"
    PATH = "path"
    INTEGRAL = "integral"
    END = "end"
    RATE = "rate"


@dataclass(frozen=True)
class PhaseRow(Row):
    """A row of a phase.

    Attributes
    ----------
    kind : Kind
    where : Where
        When it applies.
    constraint : int
        Number of its constraint in ``RowTable.constraints``.
    entry : int
        Number of the row in its constraint.
    number : int
        Number of the row in ``RowTable.rows``.
    """

    kind: Kind = Kind.PATH
    where: Where = Where.THROUGHOUT
    constraint: int = 0
    entry: int = 0
    number: int = 0

    @classmethod
    def of(cls, row: Row, where: Where, constraint: int, entry: int, number: int) -> PhaseRow:
        """Return the row of a constraint that holds ``where``, with its kind and its numbers in the table."""
        own = (row.name, row.unit, row.lower, row.upper, row.joint, row.variable, row.measure, row.selects_root)
        if where is Where.RATE:
            kind = Kind.RATE
        elif row.variable is not None:
            kind = Kind.BOUND
        elif where is Where.INTEGRAL:
            kind = Kind.INTEGRAL
        else:
            kind = Kind.END if where in (Where.START, Where.END) else Kind.PATH
        return cls(*own, kind, where, constraint, entry, number)
