"""The table of rows of a phase: each scalar row once, with its kind, bounds, unit and expression.

``Phase.rows`` builds the table once. Printing, checks, transcription, constraint generation, refinement, violations and
replay read it. The witness does not: it evaluates the definitions of the constraints itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import Enum
from functools import cached_property

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.dynamics.rows import as_rows
from robotraj.problem.constraints.base import BoundConstraint, Row, Where, symbols_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.equality_rates import EqualityRates, equality_rates


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

    @property
    def magnitude(self) -> float:
        """The largest finite bound without its sign, 0 where there is none [unit]."""
        return max((abs(bound) for bound in (self.lower, self.upper) if np.isfinite(bound)), default=0.0)

    @property
    def scale(self) -> float:
        """What a violation is measured by: 1 + ``magnitude`` [unit]."""
        return 1.0 + self.magnitude


@dataclass(frozen=True, eq=False)
class RowTable:
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

    def row(self, constraint: int, entry: int) -> PhaseRow:
        """Return a row by the numbers of its constraint and of its entry there."""
        return self._by_number[constraint, entry]

    @cached_property
    def _by_number(self) -> dict[tuple[int, int], PhaseRow]:
        return {(row.constraint, row.entry): row for row in self.rows}

    @cached_property
    def bounds(self) -> tuple[PhaseRow, ...]:
        """Rows of single variables of the dynamics, whenever they hold."""
        return self._of(Kind.BOUND)

    @cached_property
    def path(self) -> tuple[PhaseRow, ...]:
        """Expressions at the collocation points, those that define variables of the objective among them."""
        return self._of(Kind.PATH)

    @cached_property
    def integrals(self) -> tuple[PhaseRow, ...]:
        """Integrals over the phase."""
        return self._of(Kind.INTEGRAL)

    def at(self, end: Where) -> tuple[PhaseRow, ...]:
        """Return the expressions at the start alone or at the end alone."""
        return tuple(row for row in self._of(Kind.END) if row.where is end)

    def _of(self, kind: Kind) -> tuple[PhaseRow, ...]:
        return tuple(row for row in self.rows if row.kind is kind)

    @cached_property
    def state_rows(self) -> tuple[PhaseRow, ...]:
        """Rows held throughout that read state, time and parameters alone: they hold between the points as well."""
        states = {state.name for state in self.dae.states}
        found = {row for row in self.bounds if row.where is Where.THROUGHOUT and row.variable in states}
        path = [row for row in self.path if row.where is Where.THROUGHOUT]
        if path:
            point = symbols_of(self.dae, self.parameters)
            # Forward dynamics has no algebraic variables, and its accelerations read the controls.
            z = (point.z[variable.name] for variable in self.body.algebraic)
            inner = ca.vertcat(ca.SX(0, 1), *z, *point.u.values())
            values = self.values(path, point)
            found |= {row for row, value in zip(path, values, strict=True) if not ca.depends_on(value, inner)}
        return tuple(row for row in self.rows if row in found)

    @cached_property
    def equalities(self) -> tuple[EqualityRates, ...]:
        """Path rows that are equations of order 2 and more, with their rates."""
        fixed = {i: r.lower for i, r in enumerate(self.path) if r.where is Where.THROUGHOUT and r.lower == r.upper}
        if not fixed:
            return ()
        return equality_rates(self.dae, self.parameters, fixed, lambda point: self.column(self.path, point))

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

    def column(self, rows: Sequence[PhaseRow], point: Point) -> ca.SX:
        """Evaluate rows as one column, which may be empty."""
        return ca.vertcat(*self.values(rows, point)) if rows else ca.SX(0, 1)

    def tightest(self, variables: Sequence[str], *where: Where) -> Bounds:
        """Return the tightest bounds on variables by name, infinite where there is none.

        Parameters
        ----------
        variables : sequence of str
            Names of n variables of the dynamics.
        *where : Where
            Rows that hold then count; those held throughout the phase by default.

        Returns
        -------
        Bounds
            (n,) each, in the units of the variables.
        """
        place = {name: i for i, name in enumerate(variables)}
        lower, upper = np.full(len(variables), -np.inf), np.full(len(variables), np.inf)
        for row in self.bounds:
            i = place.get(str(row.variable))
            if i is not None and row.where in (where or (Where.THROUGHOUT,)):
                lower[i], upper[i] = max(lower[i], row.lower), min(upper[i], row.upper)
        return Bounds(lower, upper)


def _kind(row: Row, where: Where) -> Kind:
    if row.variable is not None:
        return Kind.BOUND
    if where is Where.INTEGRAL:
        return Kind.INTEGRAL
    return Kind.END if where in (Where.START, Where.END) else Kind.PATH
