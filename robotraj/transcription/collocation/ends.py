"""Blocks at the ends of phases: Mayer costs, constraints at one end, and links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array, Indices
from robotraj._util.errors import InputError
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Named
from robotraj.problem.augmentation import Augmented
from robotraj.problem.constraints.base import Where
from robotraj.problem.links.base import BoundLink, Ends
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.collocation import weighted_sum
from robotraj.transcription.collocation.end_functions import (
    EndFunctions,
    EndSymbols,
    end_columns,
    fixed_values,
    functions_of,
    point_functions,
    read_by,
)
from robotraj.transcription.collocation.index_reduction import (
    determined_at_ends,
    path_equalities,
    rate_row,
    shares_start,
)
from robotraj.transcription.collocation.invariants import start_invariants
from robotraj.transcription.collocation.symbols import (
    PointSymbols,
    phase_scalars,
    point_symbols,
)
from robotraj.transcription.layout import PhaseLayout, entries_of
from robotraj.transcription.scalar_table import Entry, ScalarTable


def mayer_block(phase: Phase, layout: PhaseLayout, as_tapes: bool) -> Block | None:
    """Return the weighted sum of the phase's Mayer terms; None without any."""
    if not phase.end_costs:
        return None

    def make() -> EndFunctions:
        ends = EndSymbols(phase, layout)
        cost = weighted_sum([(w, as_rows(t.value(*ends.points), "Mayer expression")[0]) for w, t in phase.end_costs])
        read = read_by(cost, ends.unknowns)
        return EndFunctions(
            point_functions(ends.unknowns[read.tolist()], ends.constants, cost, costed=0, as_tapes=as_tapes), read
        )

    known = functions_of(phase, ("Mayer", as_tapes), [layout], make)
    return single(known.stage, end_columns(layout)[known.read], fixed_values(layout), np.array([], dtype=int))


def end_constraint_blocks(
    phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, as_tapes: bool
) -> list[Block]:
    """Return the blocks of constraints that hold at the start or at the end alone."""
    blocks = []
    for where, node, fraction in ((Where.START, 0, 0.0), (Where.END, -1, 1.0)):
        held = phase.rows.at(where)
        if not held:
            continue
        interval = layout.interval(node)

        def make(held: Sequence[PhaseRow] = held) -> EndFunctions:
            s = point_symbols(phase, phase_scalars(layout))
            return _at_end(
                s, phase.rows.column(held, phase.dae.point(s.t, s.x, s.z, s.u, s.p, phase.parameter_names)), as_tapes
            )

        known = functions_of(phase, (where, as_tapes), [layout], make)
        if interval.scheme.nodes[node] != fraction and known.inner:
            raise InputError(
                f"Phase {phase.name!r}: a constraint at the {where.value} depends on accelerations or controls, but "
                f"{type(interval.scheme).__name__} has no collocation point there; use a Lobatto scheme."
            )
        added = rows.impose(index, held, np.array([fraction]))
        blocks.append(_block_at_end(layout, node, known, added[0]))
    return blocks


def _at_end(s: PointSymbols, y: ca.SX, as_tapes: bool) -> EndFunctions:
    """Return the functions of outputs y of symbols ``s`` of one point."""
    inner, read = ca.vertcat(s.z, s.u), read_by(y, s.unknowns)
    stage = point_functions(s.unknowns[read.tolist()], s.constants, y, as_tapes=as_tapes)
    return EndFunctions(stage, read, bool(inner.numel()) and ca.depends_on(y, inner))


def _block_at_end(layout: PhaseLayout, node: int, known: EndFunctions, rows: Indices) -> Block:
    """Return the block of functions ``_at_end`` at the first knot (``node`` 0) or at the last one (-1)."""
    interval, scalars = layout.interval(node), phase_scalars(layout)
    shared = [scalar.column for scalar in scalars if scalar.column is not None]
    inner = interval.algebraic[node], interval.controls[node]
    columns = np.concatenate([layout.knots[node], *inner, shared]).astype(int)
    return single(known.stage, columns[known.read], np.array([float(-node), *fixed_values(layout)]), rows)


def start_block(
    phases: Sequence[Phase],
    index: int,
    layout: PhaseLayout,
    links: Sequence[BoundLink],
    rows: ScalarTable,
    as_tapes: bool,
) -> Block | None:
    """Return the block of I(x) = 0 at the first knot of a phase; None if no row is needed."""
    phase = phases[index]
    if not phase.dae.invariants:
        return None
    kept = start_invariants(phases, index, links)
    if not kept:
        return None

    def make() -> EndFunctions:
        ends = EndSymbols(phase, layout)
        y = phase.dae.invariant(ends.points[0])[kept]
        stage = point_functions(ends.unknowns, ends.constants, y, as_tapes=as_tapes)
        return EndFunctions(stage, np.arange(stage.inputs))

    known = functions_of(phase, ("invariants", tuple(kept), as_tapes), [layout], make)
    entries = [entries_of(index, phase.dae.invariants)[i] for i in kept]
    added = rows.add(entries, np.zeros(1), 0.0, 0.0)[0]
    return single(known.stage, end_columns(layout), fixed_values(layout), added)


def start_equalities_block(
    phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, carried: frozenset[int], as_tapes: bool
) -> Block | None:
    """Return the block of path equalities at the first knot; None if no row is needed.

    If the scheme has no node there, the rows are h, ..., h^(r-1) = 0; if it has one, h^(r) = 0. For ``carried`` see
    ``index_reduction.impose_equalities``.
    """
    equations = path_equalities(phase)
    if not equations:
        return None
    scheme = layout.scheme
    s, held = point_symbols(phase, phase_scalars(layout)), phase.rows.path
    values: list[tuple[Row, ca.SX, float]] = []
    if scheme.nodes[0] > 0.0:
        for equation, (at_start, _) in zip(equations, determined_at_ends(phase, layout), strict=True):
            imposed, found = held[equation.row], equation.values(s.t, s.x, s.p)
            kept = [] if equation.row in carried else sorted(set(range(equation.order)) - at_start)
            values += [(rate_row(imposed, k) if k else imposed, found[k], 0.0 if k else equation.target) for k in kept]
    elif shares_start(scheme) and not _chooses_rates(phase):
        for equation in equations:
            row = rate_row(held[equation.row], equation.order)
            values.append((row, equation.chosen(s.t, s.x, s.z, s.u, s.p), 0.0))
    if not values:
        return None
    entries = [Entry.of(index, row) for row, _, _ in values]
    wanted = np.array([value for _, _, value in values])
    added = rows.add(entries, np.zeros(1), wanted, wanted)[0]
    # Which rows are needed depends on the mesh.
    return _block_at_end(layout, 0, _at_end(s, ca.vertcat(*(value for _, value, _ in values)), as_tapes), added)


def _chooses_rates(phase: Phase) -> bool:
    """Whether an objective made controls or accelerations states; their rates are then the controls."""
    if isinstance(phase.dae, Augmented) and phase.dae.copies:
        return True
    return not {u.name for u in phase.body.controls} <= {u.name for u in phase.dae.controls}


def link_unknowns(link: BoundLink, columns: ScalarTable) -> NDArray[np.int_]:
    """Add the columns of a link's unknowns and return them."""
    phase = link.phases[0]
    return columns.add([Entry(phase, v.quantity, v.label, v.unit) for v in link.unknowns], np.ones(1))[0]


def link_block(
    link: BoundLink,
    phases: Sequence[Phase],
    layouts: Sequence[PhaseLayout],
    own: NDArray[np.int_],
    rows: ScalarTable,
    as_tapes: bool,
) -> Block:
    """Return the block of a link between phases; ``own`` are the columns of its unknowns."""
    joined = [layouts[i] for i in link.phases]

    def make() -> EndFunctions:
        ends = [EndSymbols(phases[i], layouts[i], inner=True) for i in link.phases]
        brought = ca.SX.sym("b", len(link.unknowns))
        known = Named("unknown of the link", [v.name for v in link.unknowns], brought)
        y = ca.vertcat(*link.values([Ends(*e.points) for e in ends], known))
        unknowns, constants = ca.vertcat(*(e.unknowns for e in ends), brought), ca.vertcat(*(e.constants for e in ends))
        read = read_by(y, unknowns)
        return EndFunctions(point_functions(unknowns[read.tolist()], constants, y, as_tapes=as_tapes), read)

    known = functions_of(link, (as_tapes,), joined, make)
    added = rows.impose(link.phases[0], link.rows, np.array([1.0]))
    columns = np.concatenate([*(end_columns(layout, inner=True) for layout in joined), own])
    return single(
        known.stage, columns[known.read], np.concatenate([fixed_values(layout) for layout in joined]), added[0]
    )


def single(stage: PointFunctions, columns: NDArray[np.int_], constants: Array, rows: NDArray[np.int_]) -> Block:
    """Return a block of one place; ``widen`` extends its matrices to the size of the NLP."""
    return repeated(stage, columns[None, :], constants[None, :], rows[None, :])


def repeated(stage: PointFunctions, columns: NDArray[np.int_], constants: Array, rows: NDArray[np.int_]) -> Block:
    """Return a block of E places with columns (E, n_v), constants (E, n_c) and rows (E, n_y)."""
    gather, scatter = Triplets(), Triplets()
    gather.add(np.arange(columns.size), columns.ravel(), 1.0)
    scatter.add(rows.ravel(), np.arange(rows.size), 1.0)
    width = (int(columns.max()) if columns.size else 0) + 1
    height = (int(rows.max()) if rows.size else -1) + 1
    count = len(columns)
    return Block(
        stage,
        gather.matrix((columns.size, width)),
        np.ascontiguousarray(constants.T),
        scatter.matrix((height, count * stage.outputs)),
        np.ones(count) if stage.costed is not None else np.zeros(count),
    )


def widen(block: Block, rows: int, columns: int) -> Block:
    """Extend a block's matrices by empty rows and columns to the size of the NLP."""
    gather, scatter = block.gather.copy(), block.scatter.copy()
    gather.resize((gather.shape[0], columns))
    scatter.resize((rows, block.stage.outputs * block.count))
    return replace(block, gather=gather, scatter=scatter)
