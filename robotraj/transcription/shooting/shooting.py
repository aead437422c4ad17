"""The rows of a phase by one-step schemes: shooting and compressed collocation.

The point function covers a whole interval. With unknowns (x_0, x_1, u at the control's sites, t0, T, p) it returns

    y = ( x_1 - Phi,  states inside,  path rows inside,  cost ),

where Phi steps over the pieces of the interval one after the other. The cost is integrated as a further state. Path
rows at knots depend on unknowns of the knots alone and form another block.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.sparse import csr_array
from robotraj._util.values import dataclass
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.row import Row
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.collocation import gather_points, tie_intervals
from robotraj.transcription.collocation.symbols import interval_scalars, point_symbols
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.mesh import MovingMesh
from robotraj.transcription.schemes.onestep import OneStep

Symbols: TypeAlias = ca.SX | ca.MX


def shoot(
    phase: Phase, index: int, layout: PhaseLayout, columns: ScalarTable, rows: ScalarTable, linear: Triplets
) -> tuple[tuple[Block, Triplets, Triplets], list[Block]]:
    """Write the rows of a phase; return its block, the triplets of its gather and scatter, and further blocks."""
    interval = _Interval(phase, layout)
    stage, count = interval.stage, len(layout.intervals)
    nx, inner = interval.nx, interval.inner
    starts, lengths = (np.array([getattr(i, name) for i in layout.intervals]) for name in ("start", "length"))
    base = np.arange(count)[:, None] * stage.outputs
    scatter = Triplets()
    defects = [Entry(index, "defect", s.label if s.joint is None else s.name, s.unit) for s in phase.dae.states]
    added = rows.add(defects, starts + lengths, 0.0, 0.0)
    scatter.add(added.ravel(), (base + np.arange(nx)).ravel(), 1.0)

    def impose(held: Sequence[Row], fractions: Array, outputs: NDArray[np.int_]) -> None:
        """Impose rows at fractions of every interval; outputs (len(fractions), len(held))."""
        at = rows.impose(index, held, (starts[:, None] + lengths[:, None] * fractions).ravel())
        scatter.add(at.ravel(), (base[:, :, None] + outputs).ravel(), 1.0)

    bounds = phase.rows.bounds_of(phase.dae.states)
    which = np.array([state for _, state in bounds], dtype=int)
    states = nx + np.arange(len(inner))[:, None] * nx + which
    impose([row for row, _ in bounds], inner, states)
    path = phase.rows.path
    first = nx + len(inner) * nx
    impose(
        path,
        interval.path_at,
        first + np.arange(len(interval.path_at))[:, None] * len(path) + np.arange(len(path)),
    )
    if isinstance(layout.mesh, MovingMesh):
        tie_intervals(layout.mesh, index, layout, rows, linear)
    more = _path_at_knots(phase, index, layout, columns, rows, path) if path else []
    gather, constants = _gather(layout)
    weights = np.full(count, 1.0 if phase.integrals else 0.0)
    empty = csr_array((0, 0))
    block = Block(stage, empty, constants, empty, weights)
    return (block, gather, scatter), more


@dataclass(frozen=True, eq=False)
class Rate:
    """dX/dc over a piece of an interval, with X the state and, where there is one, the running cost.

    Attributes
    ----------
    function : casadi.Function
        (c, X, q) -> dX/dc with q = (control values of the piece, base, span, parameters, start, length); the
        time is base + (start + length c) span.
    """

    function: ca.Function
    size: int

    @classmethod
    def of(cls, phase: Phase, scheme: OneStep) -> Rate:
        """Return the rate of a phase for the control of a scheme."""
        dae = phase.dae
        nx, nu, sites = len(dae.states), len(dae.controls), scheme.piece_sites
        size = nx + bool(phase.integrals)
        c, state, values = ca.SX.sym("c"), ca.SX.sym("X", size), ca.SX.sym("u", nu, len(sites))
        base, span, start, length = (ca.SX.sym(name) for name in ("base", "span", "start", "length"))
        p = ca.SX.sym("p", len(phase.parameter_names))
        t = base + (start + length * c) * span
        u = ca.mtimes(values, _lagrange(sites, c))
        point = dae.point(t, state[:nx], ca.SX(0, 1), u, p, phase.parameter_names)
        rates = [dae.rates(point)]
        if phase.integrals:
            rates.append(sum((w * as_rows(term.rate(point), "integrand")[0] for w, term in phase.integrals), ca.SX(0)))
        q = ca.vertcat(ca.vec(values), base, span, p, start, length)
        function = ca.Function("rate", [c, state, q], [ca.densify(length * span * ca.vertcat(*rates))])
        return cls(function, size)


def _lagrange(sites: Array, c: ca.SX) -> ca.SX:
    """Return the Lagrange polynomials of the sites at a symbol, as a column."""
    values = []
    for i, site in enumerate(sites):
        others = np.delete(sites, i)
        values.append(ca.SX(1) if not len(others) else _product([(c - other) / (site - other) for other in others]))
    return ca.vertcat(*values)


def _product(factors: list[ca.SX]) -> ca.SX:
    result = factors[0]
    for factor in factors[1:]:
        result = result * factor
    return result


@dataclass(frozen=True, eq=False)
class IntervalSymbols:
    """Symbols of an interval: v = (x_0, x_1, u at the control's sites, unknown scalars), and the constants.

    Attributes
    ----------
    v, constants : casadi.SX or casadi.MX
    x0, x1 : columns (nx,)
    u : matrix (nu, sites)
    start, length, base, span : scalars
    p : list of scalars
    """

    v: Symbols
    constants: Symbols
    x0: Symbols
    x1: Symbols
    u: Symbols
    start: Symbols
    length: Symbols
    base: Symbols
    span: Symbols
    p: list[Symbols]

    @classmethod
    def of(cls, phase: Phase, layout: PhaseLayout, kind: type[Symbols]) -> IntervalSymbols:
        """Return symbols of one class, ``casadi.SX`` or ``casadi.MX``."""
        scheme, scalars = layout.scheme, interval_scalars(layout, 0)
        nx, nu, sites = len(phase.dae.states), len(phase.dae.controls), len(scheme.control_sites)
        free = [i for i, scalar in enumerate(scalars) if scalar.column is not None]
        fixed = [i for i, scalar in enumerate(scalars) if scalar.column is None]
        v = kind.sym("v", 2 * nx + sites * nu + len(free))
        constants = kind.sym("c", 2 + len(fixed))
        values = [*_entries(v)[v.numel() - len(free) :], *_entries(constants)[2:]]
        known = dict(zip([*free, *fixed], values, strict=True))
        base, span, *p = (known[i] for i in range(len(scalars)))
        u = ca.reshape(v[2 * nx : 2 * nx + sites * nu], nu, sites)
        return cls(v, constants, v[:nx], v[nx : 2 * nx], u, constants[0], constants[1], base, span, p)

    def piece(self, scheme: OneStep, j: int) -> Symbols:
        """Return the arguments of the rate of a piece beside c and the state."""
        low, high = scheme.pieces[j], scheme.pieces[j + 1]
        values = ca.vec(self.u[:, scheme.controls_of(j)])
        place = (self.start + self.length * low, self.length * (high - low))
        return ca.vertcat(values, self.base, self.span, *self.p, *place)


class _Interval:
    """The point function of one interval, and the places inside it at which path rows are imposed."""

    def __init__(self, phase: Phase, layout: PhaseLayout) -> None:
        scheme = layout.scheme
        assert isinstance(scheme, OneStep)
        self._phase = phase
        self.nx = len(phase.dae.states)
        self.inner = _inner_states(scheme)
        path_at: list[float] = []
        known = IntervalSymbols.of(phase, layout, ca.SX if scheme.scalar_graph else ca.MX)
        x1, kind = known.x1, type(known.x1)
        rate = Rate.of(phase, scheme)
        step = scheme.step(rate.function)
        rows = self._path_function()
        now = ca.vertcat(known.x0, kind.zeros(rate.size - self.nx))
        after = ca.vertcat(x1, kind.zeros(rate.size - self.nx))
        states, path = [], []
        for j, (low, high) in enumerate(zip(scheme.pieces[:-1], scheme.pieces[1:], strict=True)):
            values = known.u[:, scheme.controls_of(j)]
            q = known.piece(scheme, j)

            def impose(c: float, x: Symbols, low: float = low, high: float = high, values: Symbols = values) -> None:
                """Add the path rows at c of this piece."""
                at = low + (high - low) * c
                t = known.base + (known.start + known.length * at) * known.span
                control = ca.mtimes(values, ca.DM(scheme.control_within(np.array([c])).T))
                path.append(rows(t, x[: self.nx], control, ca.vertcat(*known.p)))
                path_at.append(at)

            if j > 0 and not _continuous(scheme):
                impose(0.0, now)
            now, inside = step(now, after, q)
            for i, c in enumerate(scheme.inner):
                states.append(inside[: self.nx, i])
                impose(float(c), inside[:, i])
            if j + 2 < len(scheme.pieces):
                states.append(now[: self.nx])
                impose(1.0, now)
        self.path_at = np.array(path_at)
        y = ca.vertcat(x1 - now[: self.nx], *states, *path, now[self.nx :])
        costed = int(y.numel()) - 1 if phase.integrals else None
        self.stage = PointFunctions(known.v, known.constants, y, costed, places=len(layout.intervals))

    def _path_function(self) -> ca.Function:
        """Return the function (t, x, u, p) -> path rows."""
        table = self._phase.rows
        t, x, _, u, p = table.symbols
        column = ca.vertcat(ca.SX(0, 1), *table.expressions(table.path))
        return ca.Function("path", [t, x, u, p], [ca.densify(column)])


def _entries(vector: Symbols) -> list[Symbols]:
    return [vector[i] for i in range(vector.numel())]


def _continuous(scheme: OneStep) -> bool:
    """Whether the control is continuous over pieces."""
    return bool(scheme.piece_sites[0] == 0.0 and scheme.piece_sites[-1] == 1.0)


def _inner_states(scheme: OneStep) -> Array:
    """Return the fractions of an interval at which the point function returns the state, in its order."""
    fractions = []
    for j, (low, high) in enumerate(zip(scheme.pieces[:-1], scheme.pieces[1:], strict=True)):
        fractions += [low + (high - low) * c for c in scheme.inner]
        fractions += [high] if j + 2 < len(scheme.pieces) else []
    return np.array(fractions)


def _path_at_knots(
    phase: Phase, index: int, layout: PhaseLayout, columns: ScalarTable, rows: ScalarTable, path: Sequence[PhaseRow]
) -> list[Block]:
    """Return the block of path rows at the knots, on both sides where the control jumps."""
    s = point_symbols(phase, interval_scalars(layout, 0))
    point = phase.dae.point(s.t, s.x, s.z, s.u, s.p, phase.parameter_names)
    stage = PointFunctions(s.unknowns, s.constants, phase.rows.column(path, point))
    gather, constants = gather_points(phase, layout)
    owners = [(layout.intervals[k], j) for k, j in layout.place_owner.tolist()]
    fractions = np.array([interval.start + interval.length * j for interval, j in owners])
    added = rows.impose(index, path, fractions)
    count = len(owners)
    scatter = Triplets()
    scatter.add(added.ravel(), np.arange(added.size), 1.0)
    block = Block(
        stage,
        gather.matrix((stage.inputs * count, columns.count)),
        constants,
        scatter.matrix((rows.count, stage.outputs * count)),
        np.zeros(count),
    )
    return [block]


def _gather(layout: PhaseLayout) -> tuple[Triplets, Array]:
    """Return the triplets of G and the constants, one place per interval."""
    read = [interval_columns(layout, k) for k in range(len(layout.intervals))]
    gather = Triplets()
    gather.add(np.arange(len(read) * len(read[0])), np.concatenate(read), 1.0)
    constants = [interval_constants(layout, k) for k in range(len(layout.intervals))]
    return gather, np.array(constants).T


def interval_columns(layout: PhaseLayout, k: int) -> NDArray[np.int_]:
    """Return the columns of the unknowns of interval k, in the order of ``IntervalSymbols``."""
    interval = layout.intervals[k]
    shared = [s.column for s in interval_scalars(layout, k) if s.column is not None]
    return np.concatenate([interval.left, interval.right, interval.controls.ravel(), shared]).astype(int)


def interval_constants(layout: PhaseLayout, k: int) -> Array:
    """Return the constants of interval k, in the order of ``IntervalSymbols``."""
    clock = layout.intervals[k].clock
    fixed = [s.value for s in interval_scalars(layout, k) if s.column is None]
    return np.array([clock.start, clock.length, *fixed], dtype=float)
