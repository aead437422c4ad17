"""Controls that one row gives are expressions, not unknowns.

A row r(v) - k u = 0 with a constant k gives u = r / k, if no other nonlinear output depends on u. The usual case is
the torque of an actuated joint in its balance. The row and the column are removed, and bounds of the column become rows
of the expression. Further outputs of the stage and linear rows that depend on u use the expression. A linear row over
the torques of several points of an interval bounds their polynomial in between. It becomes a combination of the points'
torque functions and stays in the interval's stage.

On a robot that lacks motors the balances of the other joints stay as equations. There a Newton step of the expression
differs from one of the unknown: the acrobot's swing-ups ended at twice the effort. Its torques remain unknowns (the
lifted Newton method: Albersmeyer and Diehl, SIAM Journal on Optimization 20, 2010).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.sparse import csr_array
from robotraj.solvers.stagewise.form import Eliminated, Form, Mask, taller, with_rows
from robotraj.solvers.stagewise.matrices import array, entries, entries_of, native, summed
from robotraj.solvers.stagewise.stage_cache import Kept
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.function_parts import solved_for
from robotraj.transcription.assembly.point_functions import PointFunctions

if TYPE_CHECKING:
    from robotraj.transcription.nlp import Nlp

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

_SOLVED: Kept[PointFunctions] = Kept()


def eliminate_controls(form: Form, nlp: Nlp) -> Form:
    """Eliminate what can be in every block."""
    staying = _staying(form, nlp)
    for index in range(len(form.blocks)):
        form = _eliminate(form, index, staying)
    return form


def _staying(form: Form, nlp: Nlp) -> Mask:
    """Columns of controls that are unknowns in any case."""
    staying = np.zeros(len(form.lower), dtype=bool)
    for layout, phase in zip(nlp.layouts, nlp.problem.phases, strict=True):
        robot = phase.robot
        if robot is not None and robot.root == "fixed" and not phase.contacts and robot.nu < robot.nv:
            for run in layout.runs:
                staying[run.controls] = True
    return staying


def _eliminate(form: Form, index: int, staying: Mask) -> Form:
    block = form.blocks[index]
    pairs = _pairs(form, block, staying)
    if not pairs:
        return form
    outputs, inputs = np.array(pairs).T
    count, stage = block.count, block.stage
    chosen = tuple(outputs.tolist()), tuple(inputs.tolist())
    reduced = _SOLVED.get(stage, chosen, partial(solved_for, stage, *chosen))
    # What is left of v, and where the expressions stand among the new outputs.
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
    blocks = [taller(other, many) for other in form.blocks]
    blocks[index] = replace(block, stage=reduced, gather=gather, scatter=scatter)
    gone = form.gone.copy()
    gone[flat] = True
    row_lower, row_upper = form.row_lower.copy(), form.row_upper.copy()
    # Rows without bounds are no rows: those that said what the control is have been used up.
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


def _pairs(form: Form, block: Block, staying: Mask) -> Sequence[tuple[int, int]]:
    """(output, input) of controls that can go."""
    stage = block.stage
    inputs = _private_inputs(form, block, staying)
    outputs = _private_outputs(form, block)
    if not inputs.size or not outputs.size:
        return []
    constant = stage.constant_slopes[np.ix_(outputs, inputs)]
    # NaN marks entries that are no constants.
    known = np.where(np.isnan(constant), 1.0, constant) != 0.0
    good = ~np.isnan(constant) & (constant != 0.0)
    alone = good & (known.sum(axis=0) == 1)[None, :] & (known.sum(axis=1) == 1)[:, None]
    return [(int(outputs[o]), int(inputs[i])) for o, i in np.argwhere(alone)]


def _private_inputs(form: Form, block: Block, staying: Mask) -> Indices:
    """Find inputs that are, at every place, one free column that no other place, equation or cost reads."""
    row, column, _ = entries(form.linear)
    equation = (form.row_lower == form.row_upper)[row]
    uses = np.bincount(column[equation], minlength=len(form.lower)) + (form.cost != 0.0)
    for other in form.blocks:
        uses = uses + np.bincount(other.gather.indices, minlength=len(form.lower))
    single = np.diff(block.gather.indptr) == 1
    column = np.zeros(single.size, dtype=int)
    column[single] = block.gather.indices[block.gather.indptr[:-1][single]]
    private = single & (uses[column] == 1) & (form.lower[column] < form.upper[column]) & ~staying[column]
    return np.flatnonzero(private.reshape(block.count, -1).all(axis=0))


def _private_outputs(form: Form, block: Block) -> Indices:
    """Find outputs that are, at every place, the whole of one row that must be zero."""
    alone = (form.nonlinear_entries() == 1) & (np.diff(form.linear.starts) == 0)
    alone &= (form.row_lower == form.row_upper) & (form.row_lower == form.offset)
    row, single = _rows_by_output(block)
    private = (single & alone[row]).reshape(block.count, -1).all(axis=0)
    if block.stage.costed is not None:
        private[block.stage.costed] = False
    return np.flatnonzero(private)


def _rows_by_output(block: Block) -> tuple[Indices, Mask]:
    """Row that each output of each place goes to, and whether it goes to just one, (n_y E,) both."""
    rows, columns, _ = entries(block.scatter)
    row_of = np.zeros(block.scatter.shape[1], dtype=int)
    row_of[columns] = rows
    return row_of, np.bincount(columns, minlength=row_of.size) == 1


def _with_rows(matrix: csr_array, rows: Indices) -> csr_array:
    """Keep some rows of a matrix."""
    made = native(matrix)
    return array(summed((rows.size, made.columns), entries_of(made, rows)))
