"""The table of rows of a phase: each scalar row once, with its kind, bounds, unit and expression.

``Phase.rows`` builds the table once. Printing, checks, transcription, constraint generation, refinement, violations and
replay read it. The witness does not: it evaluates the definitions of the constraints itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.point import Point
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import inputs_of
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Where
from robotraj.problem.phase_row import Kind, PhaseRow


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
        The bound constraints that impose the rows.
    """

    phase: str
    body: Dynamics
    dae: Dynamics
    parameters: tuple[str, ...]
    constraints: tuple[BoundConstraint, ...]

    @cached_property
    def _known(self) -> dict[int, list[ca.SX]]:
        return {}

    @cached_property
    def _functions(self) -> dict[tuple[int, ...], ca.Function]:
        return {}

    def __iter__(self) -> Iterator[PhaseRow]:
        return iter(self.rows)

    @cached_property
    def rows(self) -> tuple[PhaseRow, ...]:
        """All rows."""
        found: list[PhaseRow] = []
        for c, constraint in enumerate(self.constraints):
            for i, r in enumerate(constraint.rows):
                found.append(PhaseRow.of(r, constraint.where, c, i, len(found)))
        return tuple(found)

    @cached_property
    def bounds(self) -> tuple[PhaseRow, ...]:
        """Rows of single variables of the dynamics, at any time of the phase."""
        return self._of(Kind.BOUND)

    @cached_property
    def path(self) -> tuple[PhaseRow, ...]:
        """Rows of expressions that the transcription imposes at every collocation point."""
        return self._of(Kind.PATH)

    @cached_property
    def path_equalities(self) -> tuple[int, ...]:
        """Indices in ``path`` of the equalities that hold at every time."""
        return tuple(i for i, row in enumerate(self.path) if row.is_equality and row.where is Where.THROUGHOUT)

    @cached_property
    def integrals(self) -> tuple[PhaseRow, ...]:
        """Rows of integrals over the phase."""
        return self._of(Kind.INTEGRAL)

    @cached_property
    def rates(self) -> tuple[PhaseRow, ...]:
        """Rows of time derivatives of variables."""
        return self._of(Kind.RATE)

    @cached_property
    def throughout(self) -> tuple[PhaseRow, ...]:
        """Rows that hold at every time: bounds of variables and rows of expressions."""
        return tuple(row for row in self.rows if row.where is Where.THROUGHOUT)

    @cached_property
    def of_state(self) -> tuple[PhaseRow, ...]:
        """Rows that hold at every time and depend on t, x and p alone: bounds of states, and state path rows."""
        bounds = {row.number for row, _ in self.bounds_of(self.dae.states)}
        if all(row.kind is Kind.BOUND for row in self.throughout):
            return tuple(row for row in self.throughout if row.number in bounds)
        # With forward dynamics a robot's accelerations are expressions, and it has no algebraic variables.
        inner = inputs_of(self.body, self.point)

        def reads_state(row: PhaseRow) -> bool:
            if row.kind is Kind.BOUND:
                return row.number in bounds
            return not ca.depends_on(self.expressions((row,))[0], inner)

        return tuple(row for row in self.throughout if reads_state(row))

    @cached_property
    def of_inputs(self) -> tuple[PhaseRow, ...]:
        """Path rows that hold at every time and depend on controls or algebraic variables."""
        known = {row.number for row in self.of_state}
        return tuple(row for row in self.path if row.where is Where.THROUGHOUT and row.number not in known)

    def at(self, end: Where) -> tuple[PhaseRow, ...]:
        """Return the rows of expressions that hold at one end, ``Where.START`` or ``Where.END``, alone."""
        return tuple(row for row in self._of(Kind.END) if row.where is end)

    def of(self, constraint: Constraint) -> tuple[PhaseRow, ...]:
        """Return the rows of a constraint that the phase was given."""
        return tuple(row for row in self.rows if self.constraints[row.constraint].source is constraint)

    def variable_of(self, row: PhaseRow) -> Variable:
        """Return the variable that a row bounds; a row of kind ``RATE`` bounds its time derivative."""
        group, i = self._places[str(row.variable)]
        return self._groups[group][i]

    def bounds_of(self, variables: Iterable[Variable], *where: Where) -> list[tuple[PhaseRow, int]]:
        """Return the bounds of variables that hold ``where``, throughout by default, each with its variable's index."""
        return self._with_index(self._bounds_at(where), variables)

    def rates_of(self, variables: Iterable[Variable]) -> list[tuple[PhaseRow, int]]:
        """Return the rows of the time derivatives of variables, each with the index of its variable."""
        return self._with_index(self.rates, variables)

    def bounds_by_variable(self, *where: Where) -> Mapping[str, Sequence[PhaseRow]]:
        """Return the bounds that hold ``where``, throughout by default, by the names of the variables."""
        found: dict[str, list[PhaseRow]] = {}
        for row in self._bounds_at(where):
            found.setdefault(self.variable_of(row).name, []).append(row)
        return found

    def limits(self, *where: Where) -> Mapping[str, tuple[float, float]]:
        """Return the tightest bounds that hold ``where``, throughout by default, by the names of the variables."""
        return {
            name: (max(row.lower for row in rows), min(row.upper for row in rows))
            for name, rows in self.bounds_by_variable(*where).items()
        }

    def limits_of(self, variables: Sequence[Variable]) -> tuple[Array, Array]:
        """Return ``limits`` of variables as arrays (n,), infinite where there are none."""
        limits = self.limits()
        pairs = [limits.get(variable.name, (-np.inf, np.inf)) for variable in variables]
        lower, upper = np.reshape(pairs, (-1, 2)).T
        return lower, upper

    def _bounds_at(self, where: Sequence[Where]) -> tuple[PhaseRow, ...]:
        return tuple(row for row in self.bounds if row.where in (where or (Where.THROUGHOUT,)))

    def _with_index(self, rows: Sequence[PhaseRow], variables: Iterable[Variable]) -> list[tuple[PhaseRow, int]]:
        index = {variable.name: i for i, variable in enumerate(variables)}
        named = [(row, self.variable_of(row).name) for row in rows]
        return [(row, index[name]) for row, name in named if name in index]

    def _of(self, kind: Kind) -> tuple[PhaseRow, ...]:
        return tuple(row for row in self.rows if row.kind is kind)

    def values(self, rows: Sequence[PhaseRow], point: Point) -> list[ca.SX]:
        """Evaluate rows on a point of symbols; each constraint is evaluated once.

        Raises
        ------
        InputError
            An expression returns another number of values than its constraint has rows.
        """
        known = {c: self._values_of(c, point) for c in dict.fromkeys(row.constraint for row in rows)}
        return [known[row.constraint][row.entry] for row in rows]

    def column(self, rows: Sequence[PhaseRow], point: Point) -> ca.SX:
        """Evaluate rows on a point of symbols as a column, which may be empty."""
        return ca.vertcat(ca.SX(0, 1), *self.values(rows, point))

    def function(self, rows: Sequence[PhaseRow]) -> ca.Function:
        """Return the function (t, x, z, u, p) -> values (rows,); it is built once."""
        key = tuple(row.number for row in rows)
        if key not in self._functions:
            column = ca.vertcat(ca.SX(0, 1), *self.expressions(rows))
            self._functions[key] = ca.Function("rows", list(self.symbols), [ca.densify(column)])
        return self._functions[key]

    def sample(self, rows: Sequence[PhaseRow], t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
        """Evaluate rows at times.

        Parameters
        ----------
        rows : sequence of PhaseRow
        t : ndarray (m,)
            Times [s].
        x, z, u : ndarray (m, n)
            States, algebraic variables and controls of ``dae``.
        p : ndarray (np,)
            Parameters.

        Returns
        -------
        ndarray (m, rows)
        """
        out, others = self.bounded_columns(rows, x, z, u)
        if others:
            function = self.function([rows[i] for i in others])
            columns = (np.reshape(each, (len(t), -1)).T for each in (t, x, z, u))
            found = function(*columns, np.tile(np.reshape(p, (-1, 1)), (1, len(t))))
            out[:, others] = np.array(found).reshape(len(others), len(t)).T
        return out

    def bounded_columns(self, rows: Sequence[PhaseRow], x: Array, z: Array, u: Array) -> tuple[Array, list[int]]:
        """Return values (m, rows) with those of single variables filled in, and the numbers of the other rows."""
        out, others, groups = np.empty((len(x), len(rows))), [], (x, z, u)
        for i, row in enumerate(rows):
            if row.kind is Kind.BOUND:
                group, column = self._places[self.variable_of(row).name]
                out[:, i] = groups[group][:, column]
            else:
                others.append(i)
        return out, others

    @cached_property
    def _places(self) -> dict[str, tuple[int, int]]:
        """Group and column of each variable: states, algebraic variables and controls are groups 0, 1 and 2."""
        return {v.name: (group, i) for group, variables in enumerate(self._groups) for i, v in enumerate(variables)}

    @property
    def _groups(self) -> tuple[tuple[Variable, ...], ...]:
        return self.dae.states, self.dae.algebraic, self.dae.controls

    @cached_property
    def symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """Symbols of the table: columns t, x, z, u, p."""
        return phase_symbols(self.dae, self.parameters)

    @cached_property
    def point(self) -> Point:
        """The point of ``symbols``."""
        return self.dae.point(*self.symbols, self.parameters)

    def expressions(self, rows: Sequence[PhaseRow]) -> list[ca.SX]:
        """Return the expressions of rows in ``symbols``; each constraint is evaluated once."""
        for c in {row.constraint for row in rows} - self._known.keys():
            self._known[c] = self._values_of(c, self.point)
        return [self._known[row.constraint][row.entry] for row in rows]

    def _values_of(self, constraint: int, point: Point) -> list[ca.SX]:
        bound = self.constraints[constraint]
        values = evaluated(bound, point)
        if len(values) != len(bound.rows):
            raise InputError(
                f"Phase {self.phase!r}: the expression of {bound.name!r} returns {len(values)} values for "
                f"its {len(bound.rows)} rows; it must return one for each row."
            )
        return values


def evaluated(constraint: BoundConstraint, point: Point) -> list[ca.SX]:
    """Evaluate the expression of a constraint on a point of symbols, as a list of scalars."""
    return as_rows(constraint.expression(point), f"expression of {constraint.name!r}")


def phase_symbols(dae: Dynamics, parameters: Sequence[str]) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
    """Return fresh symbols of a phase: columns t (1,), x (nx,), z (nz,), u (nu,), p (np,)."""
    sizes = (1, len(dae.states), len(dae.algebraic), len(dae.controls), len(parameters))
    t, x, z, u, p = (ca.SX.sym(name, size) for name, size in zip("txzup", sizes, strict=True))
    return t, x, z, u, p
