"""An NLP without stages, as the input of the compiled solver.

    y = free columns of w, scaled;   rows = [equalities, inequalities, bounds of y]

Fixed columns become numbers. Bounds of columns are inequalities with one entry, which the linear solver eliminates on
the diagonal.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices, Mask
from robotraj._util.values import dataclass
from robotraj.native.build import load_native
from robotraj.solvers.assembled import chain_rule
from robotraj.solvers.assembled.elimination_order import elimination_groups
from robotraj.solvers.stagewise.matrices import Entries, array, entries, native, summed
from robotraj.solvers.stagewise.program import BlockProgram, StageProgram
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import scaled

if TYPE_CHECKING:
    from robotraj.native import Csr
    from robotraj.transcription.nlp import Nlp


PUSH = 1e-2
"""Distance of the start from its bounds, relative to the bound and to the range.

Source: Waechter and Biegler, Mathematical Programming 106 (2006), section 3.6.
"""


@dataclass(frozen=True, eq=False)
class Assembled:
    """An NLP, its program, and the maps between them.

    Attributes
    ----------
    nlp : Nlp
    program : StageProgram
        A program of one stage without states.
    free : ndarray of int (n_y,)
        Columns of w that are unknowns.
    values : ndarray (n_w,)
        Scaled values of the fixed columns, zero for the free ones.
    """

    nlp: Nlp
    program: StageProgram
    free: Indices
    values: Array

    def unknowns(self, w: Array) -> Array:
        """Return y for a decision vector w in physical units."""
        return np.asarray(w / self.nlp.scale)[self.free]

    def start(self, w: Array) -> Array:
        """Return y for a decision vector w in physical units, moved inside its bounds."""
        y = self.unknowns(w)
        lower, upper = (bound[self.free] for bound in _bounds(self.nlp))
        low, high = lower + _room(lower, upper), upper - _room(upper, lower)
        y = np.where(np.isfinite(lower), np.maximum(y, low), y)
        return np.where(np.isfinite(upper), np.minimum(y, high), y)

    def columns(self, y: Array) -> Array:
        """Return the decision vector w in physical units for y."""
        w = self.values.copy()
        w[self.free] = y
        return np.asarray(w * self.nlp.scale)

    def refreshed(self, nlp: Nlp) -> Assembled | None:
        """Write another NLP over the same point functions with the patterns and combinations of this one.

        Returns
        -------
        Assembled or None
            None where other bounds are finite, other columns are fixed, or the mesh or the scales differ.
        """
        first, second = _structure(self.nlp), _structure(nlp)
        if len(first) != len(second) or not all(map(np.array_equal, first, second)):
            return None
        free, values = _free(nlp)
        rows = _rows(nlp, free)
        _, shift = _linear(nlp, free, values, rows)
        blocks = tuple(
            replace(part, block=replace(part.block, constants=block.constants), shift=_gather(block, free, values)[1])
            for part, block in zip(self.program.blocks, _scaled_blocks(nlp), strict=True)
        )
        program = replace(self.program, shift=shift, blocks=blocks, lower=rows.lower, upper=rows.upper)
        return Assembled(nlp, program, free, values)

    def multipliers(self, y: Array, lam: Array) -> tuple[Array, Array]:
        """Return the multipliers of the NLP's rows (n_g,) and bounds (n_w,), in physical units.

        Those of fixed columns follow from stationarity, (grad f + J' rows + bounds)_c = 0.
        """
        nlp, w = self.nlp, self.columns(y)
        rows, bounds = self.spread(lam)
        rows, bounds = rows * nlp.row_scale, bounds / nlp.scale
        fixed = np.ones(len(bounds), dtype=bool)
        fixed[self.free] = False
        if fixed.any():
            bounds[fixed] = -(nlp.gradient(w) + nlp.jacobian(w).T @ rows)[fixed]
        return rows, bounds

    def spread(self, lam: Array) -> tuple[Array, Array]:
        """Return multipliers of the program's rows for the rows and columns of the NLP, scaled; zero elsewhere."""
        rows, bounds = np.zeros(len(self.nlp.rows)), np.zeros(len(self.nlp.variables))
        of_rows, of_columns = self.program.form_rows, self.program.bound_columns
        rows[of_rows[of_rows >= 0]] = lam[of_rows >= 0]
        bounds[of_columns[of_columns >= 0]] = lam[of_columns >= 0]
        return rows, bounds

    def carried_over(self, known: Assembled, lam: Array) -> Array:
        """Return multipliers of another program of the same problem for the rows of this one, zero for new rows."""
        rows, bounds = known.spread(lam)
        rows = np.append(rows, np.zeros(max(0, len(self.nlp.rows) - rows.size)))
        bounds = np.append(bounds, np.zeros(max(0, len(self.nlp.variables) - bounds.size)))
        of_rows, of_columns = self.program.form_rows, self.program.bound_columns
        return np.where(of_rows >= 0, rows[of_rows], bounds[of_columns])


@dataclass(frozen=True, eq=False)
class _ProgramRows:
    """Rows of the program: rows of the NLP, equalities first, then bounds of columns."""

    form_rows: Indices
    columns: Indices
    equalities: int
    lower: Array
    upper: Array
    target: Array


def assemble(nlp: Nlp) -> Assembled:
    """Write an NLP as a program of one stage without states."""
    free, values = _free(nlp)
    rows = _rows(nlp, free)
    linear, shift = _linear(nlp, free, values, rows)
    n_rows = shift.size
    number = _numbers(rows, len(nlp.rows))
    blocks, shifts = [], []
    for block in _scaled_blocks(nlp):
        gather, offset = _gather(block, free, values)
        row, column, data = entries(block.scatter)
        row = number[row]
        kept = row >= 0
        scatter = summed((n_rows, block.scatter.shape[1]), (row[kept], column[kept], data[kept]))
        blocks.append(replace(block, gather=array(gather), scatter=array(scatter)))
        shifts.append(offset)
    first = chain_rule.jacobian(blocks, linear)
    second = chain_rule.hessian(blocks, free.size)
    parts = [
        BlockProgram(block, offset, jacobian, load_native().Stacked(hessian), _gradient(block))
        for block, offset, jacobian, hessian in zip(blocks, shifts, first.parts, second.parts, strict=True)
    ]
    program = StageProgram(
        np.array([free.size]),
        np.array([0]),
        np.array([rows.equalities]),
        np.array([n_rows - rows.equalities]),
        linear,
        shift,
        np.zeros(free.size),
        0.0,
        (first.rows, first.columns),
        first.constant,
        (second.rows, second.columns),
        tuple(parts),
        rows.lower,
        rows.upper,
        rows.form_rows,
        rows.columns,
        elimination_groups(nlp, free, first.rows, first.columns, n_rows),
    )
    return Assembled(nlp, program, free, values)


def _room(bound: Array, other: Array) -> Array:
    """Distance of the start from a bound, zero where it is infinite."""
    finite = np.where(np.isfinite(bound), bound, 0.0)
    room = PUSH * np.minimum(np.maximum(1.0, np.abs(finite)), np.abs(other - finite))
    return np.where(np.isfinite(bound), room, 0.0)


def _bounds(nlp: Nlp) -> tuple[Array, Array]:
    return nlp.variables.lower / nlp.scale, nlp.variables.upper / nlp.scale


def _free(nlp: Nlp) -> tuple[Indices, Array]:
    lower, upper = _bounds(nlp)
    return np.flatnonzero(lower < upper), np.where(lower < upper, 0.0, lower)


def _structure(nlp: Nlp) -> list[Array | Mask | Indices]:
    bounds = (nlp.rows.lower, nlp.rows.upper), (nlp.variables.lower, nlp.variables.upper)
    kinds = [kind for low, high in bounds for kind in (np.isfinite(low), np.isfinite(high), low == high)]
    linear = nlp.linear
    return [nlp.scale, nlp.row_scale, linear.data, linear.indices, linear.indptr, *kinds]


def _scaled_blocks(nlp: Nlp) -> list[Block]:
    return [block.scaled(nlp.scale, nlp.row_scale) for block in nlp.blocks]


def _rows(nlp: Nlp, free: Indices) -> _ProgramRows:
    lower, upper = nlp.rows.lower * nlp.row_scale, nlp.rows.upper * nlp.row_scale
    equal = lower == upper
    equalities = np.flatnonzero(equal)
    others = np.flatnonzero(~equal & (np.isfinite(lower) | np.isfinite(upper)))
    low, high = _bounds(nlp)
    bounded = free[(np.isfinite(low) | np.isfinite(high))[free]]
    return _ProgramRows(
        np.concatenate([equalities, others, np.full(bounded.size, -1)]),
        np.append(np.full(equalities.size + others.size, -1), bounded),
        equalities.size,
        np.append(lower[others], low[bounded]),
        np.append(upper[others], high[bounded]),
        lower[equalities],
    )


def _numbers(rows: _ProgramRows, count: int) -> Indices:
    """Row of the program for each row of the NLP, -1 where there is none."""
    number = np.full(count, -1)
    kept = np.flatnonzero(rows.form_rows >= 0)
    number[rows.form_rows[kept]] = kept
    return number


def _linear(nlp: Nlp, free: Indices, values: Array, rows: _ProgramRows) -> tuple[Csr, Array]:
    """Linear part of the rows over y, and their offsets."""
    column_of = _positions(free, values.size)
    row, column, data = entries(scaled(nlp.linear, nlp.row_scale, nlp.scale))
    row = _numbers(rows, len(nlp.rows))[row]
    kept = row >= 0
    row, column, data = row[kept], column[kept], data[kept]
    shift = np.zeros(rows.form_rows.size)
    np.add.at(shift, row, data * values[column])
    shift[: rows.equalities] -= rows.target
    at = column_of[column]
    open_ = at >= 0
    bounds = np.flatnonzero(rows.columns >= 0)
    of_bounds: Entries = bounds, column_of[rows.columns[bounds]], np.ones(bounds.size)
    return summed((shift.size, free.size), (row[open_], at[open_], data[open_]), of_bounds), shift


def _gather(block: Block, free: Indices, values: Array) -> tuple[Csr, Array]:
    """Return the gather of y, and the contributions of fixed columns."""
    row, column, data = entries(block.gather)
    at = _positions(free, values.size)[column]
    open_ = at >= 0
    reads = summed((block.gather.shape[0], free.size), (row[open_], at[open_], data[open_]))
    return reads, np.asarray(block.gather @ values)


def _positions(free: Indices, count: int) -> Indices:
    position = np.full(count, -1)
    position[free] = np.arange(free.size)
    return position


def _gradient(block: Block) -> Csr | None:
    """Map from the gradients of the places to that of the objective; None where the block has no cost."""
    if not block.costs:
        return None
    return native(scaled(block.gather, rows=np.repeat(block.weights, block.stage.inputs))).transposed()
