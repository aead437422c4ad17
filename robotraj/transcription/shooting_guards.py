"""Guards of one-step schemes: rows on states between knots, on the scheme's own interpolant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from robotraj.constraints import Row
from robotraj.constraints.base import BoundConstraint
from robotraj.dynamics.system import as_rows
from robotraj.schemes import OneStep
from robotraj.transcription.block import Block
from robotraj.transcription.ends import single
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.shooting import IntervalSymbols, Rate, interval_columns, interval_constants
from robotraj.transcription.table import Entry, ScalarTable

if TYPE_CHECKING:
    from robotraj.problem import Phase


def shot_guard(
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    interval: int,
    tau: float,
    constraint: BoundConstraint,
    row: Row,
    rows: ScalarTable,
) -> Block:
    """Hold one row at tau in [0, 1] of an interval of the mesh, which in single shooting is a piece."""
    scheme = layout.intervals[0].scheme
    assert isinstance(scheme, OneStep)
    pieces = len(scheme.pieces) - 1
    k, piece = (0, interval) if pieces > 1 else (interval, 0)
    known, rate = IntervalSymbols.of(phase, layout, ca.MX), Rate.of(phase, scheme)
    nx = known.x0.numel()
    step, cost = scheme.step(rate.function), ca.MX.zeros(rate.size - nx)
    now, after = ca.vertcat(known.x0, cost), ca.vertcat(known.x1, cost)
    for j in range(piece):
        now = step(now, after, known.piece(scheme, j))[0]
    state = scheme.samples(rate.function, np.array([tau]))(now, after, known.piece(scheme, piece))[:nx]
    low, high = scheme.pieces[piece], scheme.pieces[piece + 1]
    at = low + (high - low) * tau
    time = known.base + (known.start + known.length * at) * known.span
    value = _row(phase, constraint, row)(time, state, ca.vertcat(*known.p))
    owner = layout.intervals[k]
    entry = Entry(index, row.name, row.joint or "", row.unit)
    added = rows.add([entry], np.array([owner.start + owner.length * at]), row.lower, row.upper)[0]
    return single(known.v, known.constants, value, interval_columns(layout, k), interval_constants(layout, k), added)


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
