"""Constraint generation for one-step schemes: rows of the state between knots, on the scheme's own interpolant."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis, lobatto_sites
from robotraj._util.sparse import csr_array
from robotraj._util.values import dataclass
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.scalar_table import ScalarTable
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.shooting.shooting import IntervalSymbols, Rate, interval_columns, interval_constants

Added = tuple[int, float, int]
"""Interval, tau and row number."""


def shot_rows(phase: Phase, index: int, layout: PhaseLayout, added: Sequence[Added], rows: ScalarTable) -> list[Block]:
    """Impose rows at places of intervals of the mesh, which in single shooting are pieces of one.

    Parameters
    ----------
    added : sequence of (int, float, int)
        Interval, tau in [0, 1] and row number of every added row.
    """
    scheme = layout.scheme
    assert isinstance(scheme, OneStep)
    single = len(scheme.pieces) > 2
    blocks = []
    for number in sorted({interval for interval, *_ in added}) if single else [0]:
        piece = _Piece(phase, index, layout, scheme, number)
        own = [each for each in added if not single or each[0] == number]
        bounds = [each for each in own if phase.rows.rows[each[2]].kind is Kind.BOUND]
        others = [each for each in own if phase.rows.rows[each[2]].kind is not Kind.BOUND]
        if bounds:
            blocks.append(piece.block_of_bounds(bounds, rows))
        if others:
            blocks.append(piece.block(others, rows))
    return blocks


@dataclass(frozen=True, eq=False)
class _Piece:
    """A piece of every interval of a phase; only single shooting has more than one."""

    phase: Phase
    index: int
    layout: PhaseLayout
    scheme: OneStep
    number: int

    def block_of_bounds(self, added: Sequence[Added], rows: ScalarTable) -> Block:
        """Return the block of bounds on states: a place for each interval, whose outputs are the interpolant's values.

        Every bound is a sum of them. A place for every bound would differentiate the dynamics once for each.
        """
        known, states = self._interpolated()
        which = [self._interval(interval) for interval, *_ in added]
        kept = sorted(set(which))
        stage = PointFunctions(known.v, known.constants, ca.vec(states), places=len(kept))
        component = {row.number: i for row, i in self.phase.rows.bounds_of(self.phase.dae.states)}
        sites = self._sites
        scatter, (nx, _) = Triplets(), states.shape
        for k, (_, tau, number) in zip(which, added, strict=True):
            row = self._impose(number, k, self._within(tau), rows)
            values = kept.index(k) * stage.outputs + nx * np.arange(len(sites)) + component[number]
            scatter.add(np.repeat(row, len(sites)), values, basis(sites, np.array([tau]))[0])
        constants = [interval_constants(self.layout, k) for k in kept]
        return self._gathered(stage, kept, constants, scatter.matrix((rows.count, stage.outputs * len(kept))))

    def block(self, added: Sequence[Added], rows: ScalarTable) -> Block:
        """Return the block of other rows; tau, the interpolant's weights and the choice of a row are constants."""
        kinds = sorted({number for _, _, number in added})
        which, constants, scatter = [], [], Triplets()
        for place, (interval, tau, number) in enumerate(added):
            k, at = self._interval(interval), self._within(tau)
            choice = np.zeros(len(kinds))
            choice[kinds.index(number)] = 1.0
            weights = basis(self._sites, np.array([tau]))[0]
            constants.append(np.concatenate([interval_constants(self.layout, k), weights, [at], choice]))
            which.append(k)
            scatter.add(self._impose(number, k, at, rows), np.array([place]), 1.0)
        stage = self._stage([self.phase.rows.rows[number] for number in kinds], len(added))
        return self._gathered(stage, which, constants, scatter.matrix((rows.count, len(added))))

    @property
    def _sites(self) -> Array:
        """Fractions of the piece at which states determine its interpolant."""
        return lobatto_sites(self.scheme.degree + 1)

    def _interval(self, interval: int) -> int:
        """Return the interval of the layout; single shooting has one, whose pieces are the intervals of the mesh."""
        return 0 if len(self.scheme.pieces) > 2 else interval

    def _within(self, tau: float) -> float:
        """Return the fraction of the interval of tau in this piece."""
        low, high = self.scheme.pieces[self.number], self.scheme.pieces[self.number + 1]
        return float(low + (high - low) * tau)

    def _impose(self, number: int, interval: int, at: float, rows: ScalarTable) -> NDArray[np.int_]:
        """Impose a row of the phase at a fraction of an interval; return its number in the NLP, (1,)."""
        owner = self.layout.intervals[interval]
        fractions = np.array([owner.start + owner.length * at])
        return rows.impose(self.index, [self.phase.rows.rows[number]], fractions)[0]

    def _gathered(
        self, stage: PointFunctions, intervals: Sequence[int], constants: Sequence[Array], scatter: csr_array
    ) -> Block:
        """Return the block whose places are intervals with constants."""
        columns = np.concatenate([interval_columns(self.layout, k) for k in intervals])
        gather = Triplets()
        gather.add(np.arange(len(columns)), columns, 1.0)
        shape = (len(columns), int(np.max(columns)) + 1)
        return Block(stage, gather.matrix(shape), np.array(constants).T, scatter, np.zeros(len(intervals)))

    def _interpolated(self) -> tuple[IntervalSymbols, ca.SX | ca.MX]:
        """Return the symbols of an interval, and the states of the piece at its sites as columns."""
        scheme = self.scheme
        kind = ca.SX if scheme.scalar_graph else ca.MX
        known, rate = IntervalSymbols.of(self.phase, self.layout, kind), Rate.of(self.phase, scheme)
        nx = known.x0.numel()
        step, cost = scheme.step(rate.function), kind.zeros(rate.size - nx)
        now, after = ca.vertcat(known.x0, cost), ca.vertcat(known.x1, cost)
        for j in range(self.number):
            now = step(now, after, known.piece(scheme, j))[0]
        samples = scheme.samples(rate.function, self._sites)
        return known, samples(now, after, known.piece(scheme, self.number))[:nx, :]

    def _stage(self, held: Sequence[PhaseRow], places: int) -> PointFunctions:
        """Return the value of the chosen row at the interpolated state."""
        known, states = self._interpolated()
        count = len(self._sites)
        kind, own = type(known.v), known.constants.numel()
        more = kind.sym("more", count + 1 + len(held))
        state = ca.mtimes(states, more[:count])
        time = known.base + (known.start + known.length * more[count]) * known.span
        # Rows of the state do not depend on controls, and explicit dynamics have no algebraic variables.
        controls = ca.DM.zeros(len(self.phase.dae.controls), 1)
        values = self.phase.rows.function(held)(time, state, ca.DM(0, 1), controls, ca.vertcat(*known.p))
        value = ca.dot(values, more[count + 1 :])
        chosen = ca.Function("chosen", [known.v, known.constants, more], [value])
        v, c = kind.sym("v", known.v.numel()), kind.sym("c", own + more.numel())
        return PointFunctions(v, c, chosen(v, c[:own], c[own:]), places=places)
