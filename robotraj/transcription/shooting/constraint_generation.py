"""Guards of one-step schemes: rows on states between knots, on the scheme's own interpolant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import basis, lobatto_sites
from robotraj.dynamics.rows import as_rows
from robotraj.problem.constraints.base import BoundConstraint, Row
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.shooting.shooting import IntervalSymbols, Rate, interval_columns, interval_constants
from robotraj.transcription.table import Entry, ScalarTable

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]


def shot_guards(
    phase: Phase, index: int, layout: PhaseLayout, guards: Sequence[tuple[int, float, int, int]], rows: ScalarTable
) -> list[Block]:
    """Hold rows at places of intervals of the mesh, which in single shooting are pieces of one.

    Parameters
    ----------
    guards : sequence of (int, float, int, int)
        Interval, tau in [0, 1], constraint and row of every guard.
    """
    scheme = layout.intervals[0].scheme
    assert isinstance(scheme, OneStep)
    single = len(scheme.pieces) > 2
    pieces = sorted({interval for interval, *_ in guards}) if single else [0]
    return [
        _block(phase, index, layout, scheme, piece, [g for g in guards if not single or g[0] == piece], rows)
        for piece in pieces
    ]


def _block(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    scheme: OneStep,
    piece: int,
    guards: Sequence[tuple[int, float, int, int]],
    rows: ScalarTable,
) -> Block:
    """All guards of one piece: a stage with tau, the interpolant's weights there and a choice of rows as constants."""
    kinds = sorted({(c, r) for _, _, c, r in guards})
    held = [(phase.bound_constraints[c], phase.bound_constraints[c].rows[r]) for c, r in kinds]
    sites = lobatto_sites(scheme.degree + 1)
    low, high = scheme.pieces[piece], scheme.pieces[piece + 1]
    fractions, columns, constants, scatter = [], [], [], Triplets()
    for place, (interval, tau, c, r) in enumerate(guards):
        k = 0 if len(scheme.pieces) > 2 else interval
        at, owner, row = low + (high - low) * tau, layout.intervals[k], phase.bound_constraints[c].rows[r]
        choice = np.zeros(len(kinds))
        choice[kinds.index((c, r))] = 1.0
        weights = basis(sites, np.array([tau]))[0]
        constants.append(np.concatenate([interval_constants(layout, k), weights, [at], choice]))
        columns.append(interval_columns(layout, k))
        fractions.append(owner.start + owner.length * at)
        entry = Entry(index, row.name, row.joint or "", row.unit)
        scatter.add(rows.add([entry], np.array(fractions[-1:]), row.lower, row.upper)[0], np.array([place]), 1.0)
    gather = Triplets()
    gather.add(np.arange(sum(map(len, columns))), np.concatenate(columns), 1.0)
    stage = _stage(phase, layout, scheme, piece, sites, held)
    count = len(guards)
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
    held: Sequence[tuple[BoundConstraint, Row]],
) -> PointFunctions:
    """Evaluate the chosen row at the place that the weights interpolate to."""
    kind: Any = ca.SX if scheme.scalar_graph else ca.MX
    known, rate = IntervalSymbols.of(phase, layout, kind), Rate.of(phase, scheme)
    nx, own = known.x0.numel(), known.constants.numel()
    more = kind.sym("more", len(sites) + 1 + len(held))
    step, cost = scheme.step(rate.function), kind.zeros(rate.size - nx)
    now, after = ca.vertcat(known.x0, cost), ca.vertcat(known.x1, cost)
    for j in range(piece):
        now = step(now, after, known.piece(scheme, j))[0]
    states = scheme.samples(rate.function, sites)(now, after, known.piece(scheme, piece))[:nx, :]
    state = ca.mtimes(states, more[: len(sites)])
    time = known.base + (known.start + known.length * more[len(sites)]) * known.span
    values = [_row(phase, *each)(time, state, ca.vertcat(*known.p)) for each in held]
    value = ca.dot(ca.vertcat(*values), more[len(sites) + 1 :])
    chosen = ca.Function("chosen", [known.v, known.constants, more], [value])
    v, c = kind.sym("v", known.v.numel()), kind.sym("c", own + more.numel())
    return PointFunctions(v, c, chosen(v, c[:own], c[own:]))


def _row(phase: Phase, constraint: BoundConstraint, row: Row) -> ca.Function:
    """(t, x, p) -> value of a row that reads nothing else."""
    dae = phase.dae
    t, x, p = ca.SX.sym("t"), ca.SX.sym("x", len(dae.states)), ca.SX.sym("p", len(phase.parameter_names))
    unread = ca.SX.nan(len(dae.controls))
    point = dae.point(t, x, ca.SX(0, 1), unread, p, phase.parameter_names)
    if row.variable is not None:
        value = x[[s.name for s in dae.states].index(row.variable)]
    else:
        value = as_rows(constraint.expression(point), f"expression of {constraint.name!r}")[constraint.rows.index(row)]
    return ca.Function("row", [t, x, p], [value])
