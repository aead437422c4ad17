"""Elimination of controls that one row defines.

A row r(v) - k u = 0 with a constant k gives u = r / k, if no other nonlinear output depends on u. The usual case is
the torque of an actuated joint in its balance. The row and the column are removed, and bounds of the column become rows
of the expression. Further outputs of the stage and linear rows that depend on u use the expression. A linear row over
the torques of several points of an interval bounds their polynomial in between. It becomes a combination of the points'
torque functions and stays in the interval's stage.

On a robot with passive joints, the balances of these joints remain as equations. A Newton step of the expression then
differs from one of the unknown, and the acrobot's swing-ups ended at twice the effort. Its torques remain unknowns.
Source: Albersmeyer and Diehl, The lifted Newton method, SIAM Journal on Optimization 20 (2010).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.sparse import csr_array
from robotraj.solvers.stagewise.form import Eliminated, Form, Mask, with_empty_rows, with_rows
from robotraj.solvers.stagewise.matrices import array, entries, entries_of, native, summed
from robotraj.solvers.stagewise.stage_cache import StageCache
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.function_parts import solved_for
from robotraj.transcription.assembly.point_functions import PointFunctions

if TYPE_CHECKING:
    from robotraj.transcription.nlp import Nlp

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

_SOLVED: StageCache[PointFunctions] = StageCache()


def eliminate_controls(form: Form, nlp: Nlp) -> Form:
    """Eliminate the controls of every block that one row defines."""
    remaining = _remaining(form, nlp)
    for index in range(len(form.blocks)):
        form = _eliminate(form, index, remaining)
    return form


def _remaining(form: Form, nlp: Nlp) -> Mask:
    """Return a mask of the columns of controls that remain unknowns (n_w,): those of robots with passive joints."""
    remaining = np.zeros(len(form.lower), dtype=bool)
    for layout, phase in zip(nlp.layouts, nlp.problem.phases, strict=True):
        robot = phase.robot
        if robot is not None and robot.root == "fixed" and not phase.contacts and robot.nu < robot.nv:
            for run in layout.runs:
                remaining[run.controls] = True
    return remaining


def _eliminate(form: Form, index: int, remaining: Mask) -> Form:
    block = form.blocks[index]
    pairs = _pairs(form, block, remaining)
    if not pairs:
        return form
    outputs, inputs = np.array(pairs).T
    count, stage = block.count, block.stage
    chosen = tuple(outputs.tolist()), tuple(inputs.tolist())
    reduced = _SOLVED.get(stage, chosen, partial(solved_for, stage, *chosen))
    # The remaining inputs and outputs, and the positions of the expressions among the new outputs.
    kept_in = np.delete(np.arange(stage.inputs), inputs)
    kept_out = np.delete(np.arange(stage.outputs), outputs)
    place = np.arange(count)[:, None]
    first = (place * stage.inputs + inputs).ravel()
    entry = block.gather.indptr[first]
    columns = block.gather.indices[entry].reshape(count, -1)
    factors = 1.0 / block.gather.data[entry].reshape(count, -1)
    row_of, _ = _rows_by_output(block)
    rows = row_of[place * stage.outputs + outputs]
    expressions = kept_out.size + np.arange(outputs.size)

    bounded = (np.isfinite(form.lower[columns]) | np.isfinite(form.upper[columns])).ravel()
    many = int(bounded.sum())
    n_rows = len(form.row_lower)
    width = kept_out.size + outputs.size
    moved = np.full(stage.outputs, -1)
    moved[kept_out] = np.arange(kept_out.size)
    row, column, data = entries(block.scatter)
    output = moved[column % stage.outputs]
    kept = output >= 0
    old = row[kept], column[kept] // stage.outputs * width + output[kept], data[kept]
    at, flat = (place * width + expressions).ravel(), columns.ravel()
    new = n_rows + np.arange(many), at[bounded], factors.ravel()[bounded]
    # Linear rows that read u = factor * expression.
    number = np.full(len(form.lower), -1)
    number[flat] = np.arange(flat.size)
    row, column, data = entries(form.linear)
    reads = number[column] >= 0
    which = number[column[reads]]
    moved_rows = row[reads], at[which], data[reads] * factors.ravel()[which]
    linear = summed((n_rows, len(form.lower)), (row[~reads], column[~reads], data[~reads]))
    scatter = array(summed((n_rows + many, count * width), old, new, moved_rows))
    gather = _with_rows(block.gather, (place * stage.inputs + kept_in).ravel())
    blocks = [with_empty_rows(other, many) for other in form.blocks]
    blocks[index] = replace(block, stage=reduced, gather=gather, scatter=scatter)
    gone = form.gone.copy()
    gone[flat] = True
    row_lower, row_upper = form.row_lower.copy(), form.row_upper.copy()
    # Rows without bounds are ignored. The rows that define the controls are eliminated in this way.
    row_lower[rows.ravel()], row_upper[rows.ravel()] = -np.inf, np.inf
    limited = flat[bounded]
    form = replace(
        form,
        blocks=tuple(blocks),
        linear=linear,
        row_lower=row_lower,
        row_upper=row_upper,
        gone=gone,
        eliminated=(*form.eliminated, Eliminated(index, expressions, columns, factors, rows)),
    )
    nothing = native(csr_array((many, len(form.lower))))
    return with_rows(form, nothing, form.lower[limited], form.upper[limited], bound_of=limited)


def _pairs(form: Form, block: Block, remaining: Mask) -> Sequence[tuple[int, int]]:
    """Return (output, input) of the controls that can be eliminated."""
    stage = block.stage
    inputs = _private_inputs(form, block, remaining)
    outputs = _private_outputs(form, block)
    if not inputs.size or not outputs.size:
        return []
    constant = stage.constant_slopes[np.ix_(outputs, inputs)]
    # NaN marks entries that are no constants.
    known = np.where(np.isnan(constant), 1.0, constant) != 0.0
    good = ~np.isnan(constant) & (constant != 0.0)
    alone = good & (known.sum(axis=0) == 1)[None, :] & (known.sum(axis=1) == 1)[:, None]
    return [(int(outputs[o]), int(inputs[i])) for o, i in np.argwhere(alone)]


def _private_inputs(form: Form, block: Block, remaining: Mask) -> Indices:
    """Find inputs that are one free column at every place, on which no other place, equation or cost depends."""
    row, column, _ = entries(form.linear)
    equation = (form.row_lower == form.row_upper)[row]
    uses = np.bincount(column[equation], minlength=len(form.lower)) + (form.cost != 0.0)
    for other in form.blocks:
        uses = uses + np.bincount(other.gather.indices, minlength=len(form.lower))
    single = np.diff(block.gather.indptr) == 1
    column = np.zeros(single.size, dtype=int)
    column[single] = block.gather.indices[block.gather.indptr[:-1][single]]
    private = single & (uses[column] == 1) & (form.lower[column] < form.upper[column]) & ~remaining[column]
    return np.flatnonzero(private.reshape(block.count, -1).all(axis=0))


def _private_outputs(form: Form, block: Block) -> Indices:
    """Find outputs that are, at every place, the only term of an equality row equal to zero."""
    alone = (form.nonlinear_entries() == 1) & (np.diff(form.linear.starts) == 0)
    alone &= (form.row_lower == form.row_upper) & (form.row_lower == form.offset)
    row, single = _rows_by_output(block)
    private = (single & alone[row]).reshape(block.count, -1).all(axis=0)
    if block.stage.costed is not None:
        private[block.stage.costed] = False
    return np.flatnonzero(private)


def _rows_by_output(block: Block) -> tuple[Indices, Mask]:
    """Return the row of each output of each place, and whether it is the only one, (n_y E,) both."""
    rows, columns, _ = entries(block.scatter)
    row_of = np.zeros(block.scatter.shape[1], dtype=int)
    row_of[columns] = rows
    return row_of, np.bincount(columns, minlength=row_of.size) == 1


def _with_rows(matrix: csr_array, rows: Indices) -> csr_array:
    """Keep some rows of a matrix."""
    made = native(matrix)
    return array(summed((rows.size, made.columns), entries_of(made, rows)))
