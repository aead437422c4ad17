"""Constraint generation for one-step schemes: rows of the state between knots, on the scheme's own interpolant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import basis, lobatto_sites
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.shooting.shooting import IntervalSymbols, Rate, interval_columns, interval_constants
from robotraj.transcription.table import ScalarTable

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]
Added = tuple[int, float, int]
"""Interval, tau and row number."""


def shot_rows(phase: Phase, index: int, layout: PhaseLayout, added: Sequence[Added], rows: ScalarTable) -> list[Block]:
    """Impose rows at places of intervals of the mesh, which in single shooting are pieces of one.

    Parameters
    ----------
    added : sequence of (int, float, int)
        Interval, tau in [0, 1] and row number of every added row.
    """
    scheme = layout.intervals[0].scheme
    assert isinstance(scheme, OneStep)
    single = len(scheme.pieces) > 2
    blocks = []
    for piece in sorted({interval for interval, *_ in added}) if single else [0]:
        own = [each for each in added if not single or each[0] == piece]
        bounds = [each for each in own if phase.rows.rows[each[2]].kind is Kind.BOUND]
        others = [each for each in own if phase.rows.rows[each[2]].kind is not Kind.BOUND]
        if bounds:
            blocks.append(_block_of_bounds(phase, index, layout, scheme, piece, bounds, rows))
        if others:
            blocks.append(_block(phase, index, layout, scheme, piece, others, rows))
    return blocks


def _block_of_bounds(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    scheme: OneStep,
    piece: int,
    added: Sequence[Added],
    rows: ScalarTable,
) -> Block:
    """Return the block of bounds on states: one place for each interval, whose outputs are the interpolant's values.

    Every bound is a sum of them. A place for every bound would differentiate the dynamics once for each.
    """
    sites = lobatto_sites(scheme.degree + 1)
    known, states = _interpolated(phase, layout, scheme, piece, sites)
    stage = PointFunctions(known.v, known.constants, ca.vec(states))
    which = [0 if len(scheme.pieces) > 2 else interval for interval, *_ in added]
    kept = sorted(set(which))
    component = {row.number: i for row, i in phase.rows.bounds_of(phase.dae.states)}
    low, high = scheme.pieces[piece], scheme.pieces[piece + 1]
    scatter, (nx, _) = Triplets(), states.shape
    for k, (_, tau, number) in zip(which, added, strict=True):
        owner, at = layout.intervals[k], low + (high - low) * tau
        row = rows.impose(index, [phase.rows.rows[number]], np.array([owner.start + owner.length * at]))[0]
        values = kept.index(k) * stage.outputs + nx * np.arange(len(sites)) + component[number]
        scatter.add(np.repeat(row, len(sites)), values, basis(sites, np.array([tau]))[0])
    columns = np.concatenate([interval_columns(layout, k) for k in kept])
    gather = Triplets()
    gather.add(np.arange(len(columns)), columns, 1.0)
    return Block(
        stage,
        gather.matrix((len(columns), int(np.max(columns)) + 1)),
        np.array([interval_constants(layout, k) for k in kept]).T,
        scatter.matrix((rows.count, stage.outputs * len(kept))),
        np.zeros(len(kept)),
    )


def _interpolated(
    phase: Phase, layout: PhaseLayout, scheme: OneStep, piece: int, sites: Array
) -> tuple[IntervalSymbols, ca.SX | ca.MX]:
    """Return the symbols of an interval, and the states of a piece at sites as columns."""
    kind = ca.SX if scheme.scalar_graph else ca.MX
    known, rate = IntervalSymbols.of(phase, layout, kind), Rate.of(phase, scheme)
    nx = known.x0.numel()
    step, cost = scheme.step(rate.function), kind.zeros(rate.size - nx)
    now, after = ca.vertcat(known.x0, cost), ca.vertcat(known.x1, cost)
    for j in range(piece):
        now = step(now, after, known.piece(scheme, j))[0]
    return known, scheme.samples(rate.function, sites)(now, after, known.piece(scheme, piece))[:nx, :]


def _block(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    scheme: OneStep,
    piece: int,
    added: Sequence[Added],
    rows: ScalarTable,
) -> Block:
    """Return the block of one piece; tau, the interpolant's weights and the choice of a row are constants."""
    kinds = sorted({number for _, _, number in added})
    held = [phase.rows.rows[number] for number in kinds]
    sites = lobatto_sites(scheme.degree + 1)
    low, high = scheme.pieces[piece], scheme.pieces[piece + 1]
    fractions, columns, constants, scatter = [], [], [], Triplets()
    for place, (interval, tau, number) in enumerate(added):
        k = 0 if len(scheme.pieces) > 2 else interval
        at, owner, row = low + (high - low) * tau, layout.intervals[k], phase.rows.rows[number]
        choice = np.zeros(len(kinds))
        choice[kinds.index(number)] = 1.0
        weights = basis(sites, np.array([tau]))[0]
        constants.append(np.concatenate([interval_constants(layout, k), weights, [at], choice]))
        columns.append(interval_columns(layout, k))
        fractions.append(owner.start + owner.length * at)
        scatter.add(rows.impose(index, [row], np.array(fractions[-1:]))[0], np.array([place]), 1.0)
    gather = Triplets()
    gather.add(np.arange(sum(map(len, columns))), np.concatenate(columns), 1.0)
    stage = _stage(phase, layout, scheme, piece, sites, held)
    count = len(added)
    return Block(
        stage,
        gather.matrix((stage.inputs * count, int(np.max(columns)) + 1)),
        np.array(constants).T,
        scatter.matrix((rows.count, count)),
        np.zeros(count),
    )


def _stage(
    phase: Phase,
    layout: PhaseLayout,
    scheme: OneStep,
    piece: int,
    sites: Array,
    held: Sequence[PhaseRow],
) -> PointFunctions:
    """Return the value of the chosen row at the interpolated state."""
    known, states = _interpolated(phase, layout, scheme, piece, sites)
    kind, own = type(known.v), known.constants.numel()
    more = kind.sym("more", len(sites) + 1 + len(held))
    state = ca.mtimes(states, more[: len(sites)])
    time = known.base + (known.start + known.length * more[len(sites)]) * known.span
    # Rows of the state do not depend on controls, and explicit dynamics have no algebraic variables.
    values = phase.rows.function(held)(
        time, state, ca.DM(0, 1), ca.DM.zeros(len(phase.dae.controls), 1), ca.vertcat(*known.p)
    )
    value = ca.dot(values, more[len(sites) + 1 :])
    chosen = ca.Function("chosen", [known.v, known.constants, more], [value])
    v, c = kind.sym("v", known.v.numel()), kind.sym("c", own + more.numel())
    return PointFunctions(v, c, chosen(v, c[:own], c[own:]))
