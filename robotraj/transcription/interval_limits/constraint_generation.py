"""Constraint generation: rows imposed between the collocation points, on the collocated polynomials.

A solution may violate a row between its collocation points (``interval_violations``). The row is then imposed at the
worst place as well, and the problem is solved again. This is an exchange method for semi-infinite programs. At a place
tau of an interval the state is x(tau) = x_0 + d sum_k (T f_k) int_0^tau l_k, linear in the outputs of point functions.
Source: Hettich and Kortanek, Semi-infinite programming, SIAM Review 35 (1993), section 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import casadi as ca
import numpy as np

from robotraj._util.arrays import Indices
from robotraj._util.curves.polynomials import integrals
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.end_functions import point_functions
from robotraj.transcription.collocation.ends import repeated
from robotraj.transcription.collocation.symbols import interval_scalars, point_symbols
from robotraj.transcription.extract import correction_basis
from robotraj.transcription.interval_limits.row_places import AddedRow
from robotraj.transcription.layout import IntervalLayout, PhaseLayout, entries_of
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.onestep import OneStep


def add_rows(
    added: Sequence[AddedRow],
    phases: Sequence[Phase],
    layouts: Sequence[PhaseLayout],
    columns: ScalarTable,
    rows: ScalarTable,
    linear: Triplets,
    scatters: Sequence[Triplets],
    outputs: Sequence[int],
) -> list[Block]:
    """Write the added rows, and states for path rows; ``scatters`` and ``outputs`` belong to the phases' blocks.

    Path rows at one place read the same states.
    """
    # All places of a row are in one block, which is differentiated and called once.
    alike: dict[tuple[int, int, tuple[bool, ...]], list[tuple[AddedRow, _RowAtPlace]]] = {}
    states_at: dict[tuple[int, int, float], Indices] = {}
    for each in added:
        phase, layout = phases[each.phase], layouts[each.phase]
        row = phase.rows.rows[each.row]
        if isinstance(layout.scheme, OneStep):
            continue
        interval = layout.intervals[each.interval]
        fraction = np.array([interval.start + interval.length * each.tau])
        tau = interval.clock.start + interval.clock.length * each.tau
        scatter, width = scatters[each.phase], outputs[each.phase]
        if row.kind is Kind.BOUND:
            component = next(i for bound, i in phase.rows.bounds_of(phase.dae.states) if bound.number == each.row)
            at = rows.impose(each.phase, [row], fraction)[0]
            _polynomial(at, np.array([component]), phase, interval, each.tau, linear, scatter, width)
            continue
        states = states_at.get(each.place)
        if states is None:
            states = columns.add(entries_of(each.phase, phase.dae.states), fraction)[0]
            states_at[each.place] = states
            defects = [Entry(each.phase, "state between collocation points", s.label, s.unit) for s in phase.dae.states]
            at = rows.add(defects, fraction, 0.0, 0.0)[0]
            linear.add(at, states, -1.0)
            _polynomial(at, np.arange(len(states)), phase, interval, each.tau, linear, scatter, width)
        shared = interval_scalars(layout, each.interval)
        free = np.array([c.column for c in shared if c.column is not None], dtype=int)
        fixed = [c.value for c in shared if c.column is None]
        path = rows.impose(each.phase, [row], fraction)[0]
        place = _RowAtPlace(np.concatenate([states, free]), np.array([tau, *fixed]), path)
        kind = each.phase, each.row, tuple(c.column is None for c in shared)
        alike.setdefault(kind, []).append((each, place))
    blocks = [_path_block(group[0][0], phases, layouts, [place for _, place in group]) for group in alike.values()]
    for i, (phase, layout) in enumerate(zip(phases, layouts, strict=True)):
        shot = [(each.interval, each.tau, each.row) for each in added if each.phase == i]
        if shot and isinstance(layout.scheme, OneStep):
            from robotraj.transcription.shooting.constraint_generation import shot_rows

            blocks += shot_rows(phase, i, layout, shot, rows)
    return blocks


class _RowAtPlace(NamedTuple):
    """Columns and constants of a path row at a place, and its row number."""

    columns: Indices
    constants: np.ndarray
    row: Indices


def _path_block(
    added: AddedRow, phases: Sequence[Phase], layouts: Sequence[PhaseLayout], places: list[_RowAtPlace]
) -> Block:
    """Return the block of a path row at places that differ from ``added`` only in interval and tau."""
    phase = phases[added.phase]
    table = phase.rows
    s = point_symbols(phase, interval_scalars(layouts[added.phase], added.interval))
    point = phase.dae.point(s.t, s.x, s.z, s.u, s.p, phase.parameter_names)
    (value,) = table.values((table.rows[added.row],), point)
    kept = ca.vertcat(s.x, s.unknowns[s.x.numel() + s.z.numel() + s.u.numel() :])
    columns, constants, rows = (np.array(part) for part in zip(*places, strict=True))
    return repeated(point_functions(kept, s.constants, value), columns, constants, rows)


def _polynomial(
    at: Indices,
    components: Indices,
    phase: Phase,
    interval: IntervalLayout,
    tau: float,
    linear: Triplets,
    scatter: Triplets,
    width: int,
) -> None:
    """Add x(tau) of the interval's polynomial to rows ``at``."""
    linear.add(at, interval.left[components], 1.0)
    weights = integrals(interval.scheme.nodes, np.array([tau]))[0]
    for place, weight in zip(interval.places, weights, strict=True):
        scatter.add(at, place * width + components, interval.clock.length * weight)
    held, nodes = len(phase.dae.invariants), interval.scheme.nodes
    if held:
        first = width - held - len(phase.dae.states)
        shares = correction_basis(nodes, np.array([tau]))[0]
        for place, share in zip(interval.places[nodes > 0.0], shares, strict=True):
            scatter.add(at, place * width + first + components, share)
