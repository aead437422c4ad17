"""The rows of a phase: defects, algebraic rows, path rows and the integral cost, as one block of a point function.

At a node with unknowns (x, z, u, t0, T, p) and constant fraction tau, the point function is

    y = ( T f,  g,  h,  h', T m,  T l,  W c,  I ),    t = t0 + tau T,

with f the rates, g the residual, h the path rows, and h' the rates of path equalities (``index_reduction``). m are the
rates of integral constraints, l is the integrand, I are the invariants, and W c the corrections that hold them
(``dynamics.dae``). The products with T make every row of the NLP linear in the outputs, with constant coefficients. The
defect of node j on an interval of relative length d is

    x_j - x_0 - d sum_k A_jk (T f_k) - W_j c_j = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis
from robotraj._util.sparse import csr_array
from robotraj.dynamics.contact_terms import separate_contact_terms
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.torque_symbols import separate_torques
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.index_reduction import (
    impose_equalities,
    path_equalities,
    rates_of,
)
from robotraj.transcription.collocation.invariants import impose_invariants
from robotraj.transcription.collocation.symbols import interval_scalars, point_symbols
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.interval_limits.bernstein_bounds import impose_on_states
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.layout import PhaseLayout, Scalar, entries_of
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.collocation import Collocation
from robotraj.transcription.schemes.gauss import GaussLegendre
from robotraj.transcription.schemes.mesh import MovingMesh
from robotraj.transcription.smoothness.smoothing import smoothing_rate

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase


def taus(layout: PhaseLayout) -> Array:
    """Return the constant tau of every evaluation of the point function: t = base + tau span."""
    if layout.own_clocks is None:
        return layout.place_fractions
    return np.array([layout.intervals[k].scheme.nodes[j] for k, j in layout.place_owner.tolist()])


def collocate(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    linear: Triplets,
    separate: bool = False,
    interval_limits: ConstraintGeneration | None = None,
    carried: frozenset[int] | None = frozenset(),
    smoothing: float = 0.0,
) -> tuple[Block, Triplets, Triplets]:
    """Write the rows of a phase; return its block and the triplets of its gather and scatter, still to be sized.

    Parameters
    ----------
    separate : bool
        Keep a robot's inverse dynamics out of the graph of the point function, if possible.
    carried : frozenset of int or None
        See ``index_reduction.impose_equalities``.
    smoothing : float
        See ``transcription.smoothness``.
    """
    dae = phase.dae
    stage = _stage(phase, layout, separate, smoothing)
    nx, nz, held = len(dae.states), len(dae.residuals), len(dae.invariants)
    corrected = stage.outputs - held - nx
    scatter = Triplets()
    weights = np.zeros(len(layout.place_owner))
    defects = [Entry(index, "defect", s.label if s.joint is None else s.name, s.unit) for s in dae.states]
    component = np.arange(nx)
    for run in layout.runs:
        scheme, nodes = run.scheme, run.scheme.nodes
        assert isinstance(scheme, Collocation)
        above = nodes > 0.0
        targets, coefficients = run.states[:, above], scheme.matrix[above]
        reached = run.start[:, None] + run.length[:, None] * nodes[above]
        corrections = run.places[:, above]
        if nodes[-1] < 1.0:
            targets = np.concatenate([targets, run.right[:, None]], axis=1)
            coefficients = np.vstack([coefficients, scheme.weights])
            reached = np.hstack([reached, (run.start + run.length)[:, None]])
            corrections = np.hstack([corrections, run.places[:, -1:]])
        # (intervals, targets, states), and between the last two, where rates are summed, the nodes.
        at = rows.add(defects, reached.ravel(), 0.0, 0.0).reshape(targets.shape)
        linear.add(at.ravel(), targets.ravel(), 1.0)
        linear.spread(at, run.left[:, None], -1.0)
        scatter.spread(
            at[:, :, None],
            run.places[:, None, :, None] * stage.outputs + component,
            -run.clock_length[:, None, None, None] * coefficients[:, :, None],
        )
        if held:
            scatter.spread(at, corrections[:, :, None] * stage.outputs + corrected + component, -1.0)
        np.add.at(weights, run.places, run.clock_length[:, None] * scheme.objective_weights)
    join_accelerations(phase, index, layout, rows, linear)
    fractions = layout.place_fractions
    base = np.arange(len(fractions))[:, None] * stage.outputs
    residual = rows.add(entries_of(index, dae.residuals), fractions, 0.0, 0.0)
    scatter.add(residual.ravel(), (base + nx + np.arange(nz)).ravel(), 1.0)
    table = phase.rows
    kept = table.path
    equations = path_equalities(phase)
    plain = sorted(set(range(len(kept))) - {equation.row for equation in equations})
    path = rows.impose(index, [kept[i] for i in plain], fractions)
    scatter.add(path.ravel(), (base + nx + nz + np.array(plain, dtype=int)).ravel(), 1.0)
    if equations:
        impose_equalities(phase, index, layout, rows, scatter, nx + nz, stage.outputs, carried)
    rated = len(kept) + sum(equation.order - 1 for equation in equations)
    totals = rows.impose(index, table.integrals, np.ones(1))[0]
    for i, total in enumerate(totals):
        scatter.add(np.full(len(weights), total), base[:, 0] + nx + nz + rated + i, weights)
    if held:
        impose_invariants(phase, index, layout, rows, scatter, stage.outputs)
    if interval_limits is not None:
        impose_on_states(interval_limits, phase, index, layout, rows, linear, scatter, stage.outputs)
    gather, constants = gather_points(phase, layout)
    if isinstance(layout.mesh, MovingMesh):
        tie_intervals(layout.mesh, index, layout, rows, linear)
    empty = csr_array((0, 0))
    return Block(stage, empty, constants, empty, weights, (index,)), gather, scatter


_STAGES: WeakKeyDictionary[Phase, dict[tuple[float, ...], PointFunctions]] = WeakKeyDictionary()
"""Point functions with their derivatives, for phases that are transcribed again, such as on finer meshes."""


def _stage(phase: Phase, layout: PhaseLayout, separate: bool, smoothing: float) -> PointFunctions:
    """Return the point functions of a phase: the same ones on all meshes with the same free scalars."""
    scalars = interval_scalars(layout, 0)
    key = smoothing, separate, *(scalar.column is not None for scalar in scalars)
    known = _STAGES.setdefault(phase, {})
    if key not in known:
        known[key] = _make_stage(phase, scalars, separate, smoothing)
    return known[key]


def _make_stage(phase: Phase, scalars: Sequence[Scalar], separate: bool, smoothing: float) -> PointFunctions:
    s = point_symbols(phase, scalars)
    dae = phase.dae
    point = dae.point(s.t, s.x, s.z, s.u, s.p, phase.parameter_names)
    torques, c = separate_torques(point) if separate else None, ca.SX.sym("c", len(dae.invariants))
    contacts = () if torques is None else separate_contact_terms(phase.body, point, c)
    costs = [(w, as_rows(term.rate(point), "integrand")[0]) for w, term in phase.integrals]
    smoothed = smoothing_rate(phase, smoothing, s.z, s.u)
    if smoothed is not None:
        costs.append((1.0, smoothed))
    integrand = weighted_sum(costs)
    path, sums = (phase.rows.column(rows, point) for rows in (phase.rows.path, phase.rows.integrals))
    # The last two are mostly empty, and a product takes time even then.
    rates, *more = (s.duration * part if part.numel() else part for part in (dae.rates(point), sums, integrand))
    equations = rates_of(phase, s.t, s.x, s.p)
    y = ca.vertcat(*(part for part in (rates, dae.residual(point), path, *equations, *more) if part.numel()))
    costed = int(y.numel()) - 1 if costs else None
    if not dae.invariants:
        return PointFunctions(s.unknowns, s.constants, y, costed, torques, contacts, separate)
    y = ca.vertcat(y, dae.correction(point, c), dae.invariant(point))
    return PointFunctions(ca.vertcat(s.unknowns, c), s.constants, y, costed, torques, contacts, separate)


def weighted_sum(terms: Sequence[tuple[float, ca.SX]]) -> ca.SX:
    """Return the sum of weighted terms, 0 without terms."""
    parts = [term if weight == 1.0 else weight * term for weight, term in terms]
    return sum(parts[1:], parts[0]) if parts else ca.SX(0)


def gather_points(phase: Phase, layout: PhaseLayout) -> tuple[Triplets, Array]:
    """Return the triplets of G and the constants, for every evaluation."""
    dae = phase.dae
    nx, nz, nu = len(dae.states), len(dae.algebraic), len(dae.controls)
    shared = np.array(
        [
            [s.column for s in interval_scalars(layout, k) if s.column is not None]
            for k in range(layout.count if layout.own_clocks is not None else 1)
        ],
        dtype=int,
    )
    scalars = shared.shape[1]
    size = nx + nz + nu + scalars + len(dae.invariants)
    gather = Triplets()
    which, node = layout.place_owner.T
    base = np.arange(len(which))[:, None] * size
    for run in layout.runs:
        nodes, interpolation = run.scheme.nodes, run.scheme.control_at_nodes
        for j in range(len(nodes)):
            chosen = np.flatnonzero((which >= run.which[0]) & (which <= run.which[-1]) & (node == j))
            own, first = which[chosen] - run.which[0], base[chosen]
            gather.spread(first + np.arange(nx), run.states[own, j], 1.0)
            gather.spread(first + nx + np.arange(nz), run.algebraic[own, j], 1.0)
            for site in np.flatnonzero(interpolation[j]):
                gather.spread(first + nx + nz + np.arange(nu), run.controls[own, site], interpolation[j, site])
            if dae.invariants and nodes[j] > 0.0:
                corrections = run.corrections[own, j - int(nodes[0] == 0.0)]
                gather.spread(first + size - corrections.shape[1] + np.arange(corrections.shape[1]), corrections, 1.0)
    gather.spread(base + nx + nz + nu + np.arange(scalars), shared[which if len(shared) > 1 else 0], 1.0)
    fixed = [scalar.value for scalar in interval_scalars(layout, 0) if scalar.column is None]
    constants = np.empty((1 + len(fixed), len(which)))
    constants[0], constants[1:] = taus(layout), np.array(fixed)[:, None]
    return gather, constants


def tie_intervals(mesh: MovingMesh, index: int, layout: PhaseLayout, rows: ScalarTable, linear: Triplets) -> None:
    """Add the rows of a moving mesh: intervals are adjacent, fill the phase and have bounded lengths.

    s_0 = t0,  s_{k+1} = s_k + h_k,  sum h_k = T,  least d_k T <= h_k <= most d_k T.
    """
    assert layout.own_clocks is not None
    starts, spans = layout.own_clocks.T
    count = layout.count
    fractions = mesh.knots[:-1]
    shares = mesh.lengths

    def add(name: str, at: Array, lower: Array | float, upper: Array | float) -> NDArray[np.int_]:
        lower, upper = (np.reshape(np.broadcast_to(side, len(at)), (-1, 1)) for side in (lower, upper))
        return rows.add([Entry(index, name, "", "s")], at, lower, upper)[:, 0]

    def subtract(at: NDArray[np.int_], scalar: Scalar, factors: Array) -> None:
        """Add - factors * scalar to the left of the rows, if it is a column."""
        if scalar.column is not None:
            linear.add(at, np.full(len(at), scalar.column), -factors)

    # Scalars that are no columns are fixed values, which are added to the bounds.
    begin, total = layout.t0.value, layout.duration.value
    first = add("start of the first interval", fractions[:1], begin, begin)
    linear.add(first, starts[:1], 1.0)
    subtract(first, layout.t0, np.ones(1))
    follow = add("intervals follow each other", fractions[1:], 0.0, 0.0)
    linear.add(follow, starts[1:], 1.0)
    linear.add(follow, starts[:-1], -1.0)
    linear.add(follow, spans[:-1], -1.0)
    whole = add("intervals fill the phase", np.array([1.0]), total, total)
    linear.add(np.repeat(whole, count), spans, 1.0)
    subtract(whole, layout.duration, np.ones(1))
    least = add("least length of interval", fractions, mesh.least * shares * total, np.inf)
    linear.add(least, spans, 1.0)
    subtract(least, layout.duration, mesh.least * shares)
    most = add("greatest length of interval", fractions, -np.inf, mesh.most * shares * total)
    linear.add(most, spans, 1.0)
    subtract(most, layout.duration, mesh.most * shares)


def join_accelerations(phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, linear: Triplets) -> None:
    """Add the rows of the knots between intervals of joined schemes."""
    joined = [run for run in layout.runs if isinstance(run.scheme, GaussLegendre) and run.scheme.joined]
    if not joined or not is_exact(phase, [run.scheme for run in layout.runs]):
        return
    joints = [i for i, variable in enumerate(phase.dae.algebraic) if variable.name.startswith("a.")]
    variables = [phase.dae.algebraic[i] for i in joints]
    entries = [Entry(index, "continuity", variable.name, variable.unit) for variable in variables]
    for run in joined:
        before, after = basis(run.scheme.nodes, np.array([1.0, 0.0]))
        at = rows.add(entries, run.start[1:], 0.0, 0.0)
        for node, (last, first) in enumerate(zip(before, after, strict=True)):
            linear.spread(at, run.algebraic[:-1, node][:, joints], last)
            linear.spread(at, run.algebraic[1:, node][:, joints], -first)
