"""Index reduction: path equalities of the state are imposed with their rates.

A path equality h(t, x, p) = 0 has order r if its rates h', ..., h^(r-1), along dx/dt = f, depend neither on controls
nor on algebraic variables, and h^(r) does. The pose of a frame has order 2. If it were imposed at every collocation
point, controls along it would oscillate from point to point. The rates at the end of the phase would not be determined
either. With a fixed end, at rest for example, the problem would have more rows than unknowns.

Instead, the rows at the last r points of an interval are replaced by h, h', ..., h^(r-1) at the last one. For
Hermite-Simpson these are the pose and the velocity at every knot. At the mid-point, as between all points, the
polynomial satisfies the equality to the scheme's order; the rest is reported with the violations between points.
Schemes with a point at the start of an interval share its controls with the interval before. At the start of the phase
h^(r) = 0 determines them; no other row would, and their error would oscillate from knot to knot.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed., sections VI.7 and VII.4; Betts,
Practical Methods for Optimal Control (2010), section 4.12.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.rows import RowTable
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.collocation import Scheme

HIGHEST = 4
"""Highest order that is reduced. Expressions of higher rates grow, and robots have no such equalities."""
DETERMINED = 1e-9
"""Largest error of an equality or a rate, in its unit, that is determined by a fixed end."""


@dataclass(frozen=True, eq=False)
class PathEquality:
    """One path row that is an equality of order r >= 2.

    Attributes
    ----------
    row : int
        Index among the path rows of the phase.
    order : int
    values : casadi.Function
        (t, x, p) -> (h, h', ..., h^(r-1)).
    chosen : casadi.Function
        (t, x, z, u, p) -> h^(r).
    target : float
        Required value of h.
    """

    row: int
    order: int
    values: ca.Function
    chosen: ca.Function
    target: float

    def expressions(self) -> tuple[ca.SX, ca.SX]:
        """Return symbols (t, x, p) as one column, and h - target, h', ... as expressions of them."""
        arguments = [ca.SX.sym(name, self.values.size1_in(i)) for i, name in enumerate("txp")]
        return ca.vertcat(*arguments), self.values(*arguments) - ca.DM([self.target] + [0.0] * (self.order - 1))


def path_equalities(phase: Phase) -> tuple[PathEquality, ...]:
    """Return the equalities of order 2 and more among the path rows of a phase."""
    # Phases that differ in their ends alone share a table.
    if phase.rows not in _EQUALITIES:
        _EQUALITIES[phase.rows] = tuple(_find(phase.rows))
    return _EQUALITIES[phase.rows]


_EQUALITIES: WeakKeyDictionary[RowTable, tuple[PathEquality, ...]] = WeakKeyDictionary()


def _find(table: RowTable) -> list[PathEquality]:
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
            found.append(PathEquality(i, len(rates), known, chosen, table.path[i].lower))
    return found


def rates_of(phase: Phase, t: ca.SX, x: ca.SX, p: ca.SX) -> list[ca.SX]:
    """Return the rates h', ..., h^(r-1) of all equalities, one after the other."""
    return [equation.values(t, x, p)[1:] for equation in path_equalities(phase)]


def impose_equalities(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    scatter: Triplets,
    first: int,
    outputs: int,
    carried: frozenset[int] | None,
) -> None:
    """Write the rows of all equalities.

    Parameters
    ----------
    first : int
        The first path row among the ``outputs`` of the phase's stage; the rates follow the last one.
    carried : frozenset of int or None
        Path rows that links impose at the start of the phase already; None if velocities jump there.
    """
    held = phase.rows.path
    output = first + len(held)
    for equation, (at_start, at_end) in zip(path_equalities(phase), determined_at_ends(phase, layout), strict=True):
        row = held[equation.row]
        places = _places(layout, equation.order, at_end)
        begins = layout.scheme.nodes[0] == 0.0 and not (carried and equation.row in carried)
        start = layout.interval(0).places[: int(begins)]
        at = np.append(start, places[0])
        _impose(row, index, layout, rows, scatter, at, outputs, first + equation.row, row.lower)
        for k in range(1, equation.order):
            at = places[k] if carried is None or k in at_start else np.append(start, places[k])
            _impose(rate_row(row, k), index, layout, rows, scatter, at, outputs, output + k - 1, 0.0)
        output += equation.order - 1


def rate_row(row: Row, k: int) -> Row:
    """Return the row of h^(k) = 0."""
    unit = f"{row.unit or '1'}/s" + (f"^{k}" if k > 1 else "")
    return Row(f"rate of {row.name}" if k == 1 else f"rate {k} of {row.name}", unit, 0.0, 0.0, row.joint)


def _places(layout: PhaseLayout, order: int, determined: frozenset[int]) -> list[Indices]:
    """Return the places of an equality above knots, and those of each of its rates.

    Rows that the end of the phase determines are not imposed at the last point, which is the end or next to it. An
    equality in intervals of fewer points than its order is not imposed just before the end either.
    """
    parts: list[list[Indices]] = [[np.zeros(0, dtype=int)] for _ in range(order)]
    for run in layout.runs:
        inner, choices = run.places[:, run.scheme.nodes > 0.0], _choices(run.scheme)
        kept = min(order, choices)
        parts[0].append(np.column_stack([inner[:, : choices - kept], inner[:, -1:][:, :kept]]).ravel())
        for k in range(1, kept):
            parts[k].append(inner[:, -1])
    at = [np.concatenate(each) for each in parts]
    scheme = layout.interval(-1).scheme
    alone = order - min(order, _choices(scheme))
    if alone and determined >= set(range(1, order)):
        at[0] = np.delete(at[0], np.s_[-1 - alone : -1])
    last = layout.interval(-1).places[-1]
    for k in determined if scheme.nodes[-1] < 1.0 else determined - {0}:
        at[k] = at[k][at[k] != last]
    return at


def _choices(scheme: Scheme) -> int:
    """Return the number of control values of an interval that are not shared with the interval before."""
    return min(int(np.sum(scheme.nodes > 0.0)), len(scheme.control_sites) - int(shares_start(scheme)))


def shares_start(scheme: Scheme) -> bool:
    """Whether an interval shares its first control value with the interval before."""
    return len(scheme.control_sites) > 1 and bool(scheme.control_sites[0] == 0.0)


def _impose(
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


def determined_at_ends(phase: Phase, layout: PhaseLayout) -> list[tuple[frozenset[int], frozenset[int]]]:
    """Return for every equality which of h, h', ... the fixed start and the fixed end determine."""
    t0, duration = layout.t0, layout.duration
    start = np.nan if t0.column is not None else t0.value
    end = np.nan if duration.column is not None else start + duration.value
    ends = (start, phase.start_bounds), (end, phase.end_bounds)
    parameters = _fixed(phase.parameter_bounds, len(phase.parameter_names))
    known = [np.concatenate([[t], _fixed(bounds, len(phase.dae.states)), parameters]) for t, bounds in ends]
    found = []
    for equation in path_equalities(phase):
        at_start, at_end = (frozenset(_determined_by(values, *equation.expressions())) for values in known)
        found.append((at_start, at_end))
    return found


def _determined_by(values: Array, symbols: ca.SX, expressions: ca.SX) -> list[int]:
    """Return the expressions that are zero for the known values; unknown ones are NaN."""
    fixed = np.flatnonzero(np.isfinite(values)).tolist()
    if fixed:
        expressions = ca.substitute(expressions, symbols[fixed], ca.DM(values[fixed]))
    each = ((k, expressions[k]) for k in range(expressions.numel()))
    return [k for k, value in each if value.is_constant() and abs(float(value)) <= DETERMINED]


def _fixed(bounds: Bounds, size: int) -> Array:
    """Return fixed values, NaN for free ones, (size,); states that an objective added are free."""
    values = np.full(size, np.nan)
    values[: len(bounds.lower)] = np.where(bounds.lower == bounds.upper, bounds.lower, np.nan)
    return values


def carried_equalities(phases: Sequence[Phase], index: int, links: Sequence[BoundLink]) -> frozenset[int] | None:
    """Return the path equalities that hold at the start of a phase because the phase before holds the same.

    None if an impact changes the velocities: the equalities are imposed after it.
    """
    rows: set[int] = set()
    for link in links:
        for carry in link.carries:
            if carry.target != index:
                continue
            if link.unknowns:
                return None
            # From one period to the next, time and places may change.
            if carry.source < index and "contact velocity" in carry.quantities:
                before = path_equalities(phases[carry.source])
                rows |= {e.row for e in path_equalities(phases[index]) if any(_alike(e, other) for other in before)}
    return frozenset(rows)


def _alike(first: PathEquality, other: PathEquality) -> bool:
    """Whether two equalities are the same; equalities of parameters are not, since each phase has its own."""
    sizes = [first.values.size1_in(i) for i in range(3)]
    same = first.order == other.order and first.target == other.target and sizes[2] == 0
    if not same or sizes != [other.values.size1_in(i) for i in range(3)]:
        return False
    rng = np.random.default_rng(0)
    points = [[rng.standard_normal(size) for size in sizes] for _ in range(3)]
    values = [[np.array(each.values(*point)).ravel() for point in points] for each in (first, other)]
    return bool(np.array_equal(values[0], values[1]))
