"""Constraint generation for one-step schemes: rows of the state between knots, on the scheme's own interpolant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import basis, lobatto_sites
from robotraj.problem.phase_row import PhaseRow
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
    pieces = sorted({interval for interval, *_ in added}) if single else [0]
    return [
        _block(phase, index, layout, scheme, piece, [each for each in added if not single or each[0] == piece], rows)
        for piece in pieces
    ]


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
    kind = ca.SX if scheme.scalar_graph else ca.MX
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
    # Rows of the state do not depend on controls, and explicit dynamics have no algebraic variables.
    values = phase.rows.function(held)(
        time, state, ca.DM(0, 1), ca.DM.zeros(len(phase.dae.controls), 1), ca.vertcat(*known.p)
    )
    value = ca.dot(values, more[len(sites) + 1 :])
    chosen = ca.Function("chosen", [known.v, known.constants, more], [value])
    v, c = kind.sym("v", known.v.numel()), kind.sym("c", own + more.numel())
    return PointFunctions(v, c, chosen(v, c[:own], c[own:]))
