"""Equations of the path that say where the state is: held with their rates, so that the motion has a choice left.

An equation h(t, x, p) = 0 has order r if its rates h', ..., h^(r-1), along dx/dt = f, read neither controls nor
algebraic variables and the next one does: 2 for the pose of a frame, whose accelerations are chosen. Imposed at
every collocation point it leaves what is chosen along it nothing but an oscillation from point to point, and the rates
at the end of the phase to chance: where the end is fixed, as at rest, there are more rows than unknowns. Here the last
r of an interval's points give way to h, h', ..., h^(r-1) at the last one. For Hermite-Simpson these are the pose and
the velocity at every knot; at the point in the middle, as between all points, the polynomial keeps to the equation to
the scheme's order, and what it leaves is told like everything between the points. Schemes with a point at the start of
an interval share what is chosen there with the interval before; at the start of the phase h^(r) = 0 chooses it, for
nothing else would, and what it is would swing on from knot to knot.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed., sections VI.7 and VII.4; Betts,
Practical Methods for Optimal Control (2010), section 4.12.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.problem.constraints.base import Row
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.rows import RowTable
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.table import Entry, ScalarTable

if TYPE_CHECKING:
    from robotraj.problem.links.base import BoundLink
    from robotraj.problem.phase import Phase
    from robotraj.transcription.layout import PhaseLayout
    from robotraj.transcription.schemes.collocation import Scheme

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

HIGHEST = 4
"""Order beyond which equations are held as they are: rates of rates grow, and none is known from robots."""
SETTLED = 1e-9
"""How far an equation or a rate may be off, in its own unit, where an end that is fixed settles it."""


@dataclass(frozen=True, eq=False)
class Equation:
    """One path row that is an equation of order r >= 2.

    Attributes
    ----------
    row : int
        Its number among the path rows of the phase.
    order : int
    values : casadi.Function
        (t, x, p) -> (h, h', ..., h^(r-1)).
    chosen : casadi.Function
        (t, x, z, u, p) -> h^(r).
    target : float
        What h is.
    """

    row: int
    order: int
    values: ca.Function
    chosen: ca.Function
    target: float

    def expressions(self) -> tuple[ca.SX, ca.SX]:
        """Give symbols (t, x, p) in one column, and what they make h - target, h', ..."""
        # Not kept: a phase goes to other processes with what it keeps, and symbols do not.
        arguments = [ca.SX.sym(name, self.values.size1_in(i)) for i, name in enumerate("txp")]
        return ca.vertcat(*arguments), self.values(*arguments) - ca.DM([self.target] + [0.0] * (self.order - 1))


Equations = tuple[Equation, ...]


def equations_of(phase: Phase) -> Equations:
    """Equations of order 2 and more among the path rows of a phase."""
    # Phases that differ in their ends alone share one table.
    if phase.rows not in _EQUATIONS:
        _EQUATIONS[phase.rows] = tuple(_find(phase.rows))
    return _EQUATIONS[phase.rows]


_EQUATIONS: WeakKeyDictionary[RowTable, Equations] = WeakKeyDictionary()


def _find(table: RowTable) -> list[Equation]:
    if not table.path_equalities:
        return []
    t, x, z, u, p = table.symbols
    inner = ca.vertcat(z, u)
    flow: ca.SX | None = None
    found = []
    for i in table.path_equalities:
        rate = table.expressions((table.path[i],))[0]
        rates: list[ca.SX] = []
        while len(rates) < HIGHEST and not ca.depends_on(rate, inner) and ca.depends_on(rate, x):
            rates.append(rate)
            flow = table.dae.rates(table.point) if flow is None else flow
            rate = ca.mtimes(ca.jacobian(rate, x), flow) + ca.jacobian(rate, t)
        if ca.depends_on(rate, inner) and len(rates) > 1:
            known = ca.Function("values", [t, x, p], [ca.vertcat(*rates)])
            chosen = ca.Function("chosen", [t, x, z, u, p], [rate])
            found.append(Equation(i, len(rates), known, chosen, table.path[i].lower))
    return found


def rates_of(phase: Phase, t: ca.SX, x: ca.SX, p: ca.SX) -> list[ca.SX]:
    """Rates h', ..., h^(r-1) of all equations, one after the other."""
    return [equation.values(t, x, p)[1:] for equation in equations_of(phase)]


def hold_equations(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    scatter: Triplets,
    first: int,
    outputs: int,
    carried: frozenset[int] | None,
) -> None:
    """Write the rows of all equations.

    Parameters
    ----------
    first : int
        The first path row among the ``outputs`` of the phase's stage; the rates follow the last one.
    carried : frozenset of int or None
        Path rows that hold at the start of the phase anyway; None where its velocities jump there.
    """
    held = phase.rows.path
    output = first + len(held)
    for equation, (at_start, at_end) in zip(equations_of(phase), settled(phase, layout), strict=True):
        row = held[equation.row]
        places = _places(layout, equation.order, at_end)
        begins = layout.intervals[0].scheme.nodes[0] == 0.0 and not (carried and equation.row in carried)
        start = layout.intervals[0].places[: int(begins)]
        at = np.append(start, places[0])
        _hold(row, index, layout, rows, scatter, at, outputs, first + equation.row, row.lower)
        for k in range(1, equation.order):
            at = places[k] if carried is None or k in at_start else np.append(start, places[k])
            _hold(rate_row(row, k), index, layout, rows, scatter, at, outputs, output + k - 1, 0.0)
        output += equation.order - 1


def rate_row(row: Row, k: int) -> Row:
    """Name h^(k) = 0 of a row."""
    unit = f"{row.unit or '1'}/s" + (f"^{k}" if k > 1 else "")
    return Row(f"rate of {row.name}" if k == 1 else f"rate {k} of {row.name}", unit, 0.0, 0.0, row.joint)


def _places(layout: PhaseLayout, order: int, settled: frozenset[int]) -> list[Indices]:
    """Where the equation stands above knots, and where each of its rates does.

    What the end of the phase settles is not said twice: not at the last point, which is the end or, where a scheme
    stops short of it, next to it; and of an equation that stands alone in intervals of fewer points than its order,
    not just before the end.
    """
    at: list[list[int]] = [[] for _ in range(order)]
    for interval in layout.intervals:
        inner = interval.places[interval.scheme.nodes > 0.0]
        choices = _choices(interval.scheme)
        kept = min(order, choices)
        at[0] += inner[: choices - kept].tolist()
        for k in range(kept):
            at[k].append(int(inner[-1]))
    scheme = layout.intervals[-1].scheme
    alone = order - min(order, _choices(scheme))
    if alone and settled >= set(range(1, order)):
        del at[0][-1 - alone : -1]
    last = layout.intervals[-1].places[-1]
    for k in settled if scheme.nodes[-1] < 1.0 else settled - {0}:
        at[k] = [place for place in at[k] if place != last]
    return [np.array(each, dtype=int) for each in at]


def _choices(scheme: Scheme) -> int:
    """How many times in an interval something new is chosen, those shared with the interval before left out."""
    return min(int(np.sum(scheme.nodes > 0.0)), len(scheme.control_sites) - int(shares_start(scheme)))


def shares_start(scheme: Scheme) -> bool:
    """Whether what is chosen at the start of an interval is what was chosen at the end of the one before."""
    return len(scheme.control_sites) > 1 and bool(scheme.control_sites[0] == 0.0)


def _hold(
    row: Row,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    scatter: Triplets,
    at: Indices,
    outputs: int,
    output: int,
    value: float,
) -> None:
    added = rows.add([Entry.of(index, row)], layout.place_fractions[at], value, value)[:, 0]
    scatter.add(added, at * outputs + output, 1.0)


def settled(phase: Phase, layout: PhaseLayout) -> list[tuple[frozenset[int], frozenset[int]]]:
    """Which of h, h', ... are as they must be at the start and at the end whatever is chosen, of every equation."""
    t0, duration = layout.t0, layout.duration
    start = np.nan if t0.column is not None else t0.value
    end = np.nan if duration.column is not None else start + duration.value
    ends = (start, phase.start_bounds), (end, phase.end_bounds)
    parameters = _fixed(phase.parameter_bounds, len(phase.parameter_names))
    known = [np.concatenate([[t], _fixed(bounds, len(phase.dae.states)), parameters]) for t, bounds in ends]
    found = []
    for equation in equations_of(phase):
        at_start, at_end = (frozenset(_settled_by(values, *equation.expressions())) for values in known)
        found.append((at_start, at_end))
    return found


def _settled_by(values: Array, symbols: ca.SX, expressions: ca.SX) -> list[int]:
    """Which expressions are zero by the values that are known, NaN where none is."""
    fixed = np.flatnonzero(np.isfinite(values)).tolist()
    if fixed:
        expressions = ca.substitute(expressions, symbols[fixed], ca.DM(values[fixed]))
    each = ((k, expressions[k]) for k in range(expressions.numel()))
    return [k for k, value in each if value.is_constant() and abs(float(value)) <= SETTLED]


def _fixed(bounds: Bounds, size: int) -> Array:
    """Values that are fixed, NaN where they are free, (size,); states that an objective added are free."""
    values = np.full(size, np.nan)
    values[: len(bounds.lower)] = np.where(bounds.lower == bounds.upper, bounds.lower, np.nan)
    return values


def carried(phases: Sequence[Phase], index: int, links: Sequence[BoundLink]) -> frozenset[int] | None:
    """Path rows whose equations hold at the start of a phase since the phase before, which runs on, holds the same.

    None where an impact changes the velocities: there they are its own to say.
    """
    rows: set[int] = set()
    for link in links:
        for carry in link.carries:
            if carry.target != index:
                continue
            if link.unknowns:
                return None
            # Where a motion repeats itself, time and places may have moved on.
            if carry.source < index and "contact velocity" in carry.quantities:
                before = equations_of(phases[carry.source])
                rows |= {e.row for e in equations_of(phases[index]) if any(_alike(e, other) for other in before)}
    return frozenset(rows)


def _alike(one: Equation, other: Equation) -> bool:
    """Whether two equations are the same, of the same value; of parameters, which phases have of their own, none is."""
    sizes = [one.values.size1_in(i) for i in range(3)]
    same = one.order == other.order and one.target == other.target and sizes[2] == 0
    if not same or sizes != [other.values.size1_in(i) for i in range(3)]:
        return False
    rng = np.random.default_rng(0)
    points = [[rng.standard_normal(size) for size in sizes] for _ in range(3)]
    values = [[np.array(each.values(*point)).ravel() for point in points] for each in (one, other)]
    return bool(np.array_equal(values[0], values[1]))
