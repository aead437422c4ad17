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
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices, Mask
from robotraj._util.sparse import csr_array
from robotraj.solvers.stagewise.form import Eliminated, Form, with_empty_rows, with_rows
from robotraj.solvers.stagewise.matrices import array, entries, entries_of, native, summed
from robotraj.solvers.stagewise.stage_cache import StageCache
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.function_parts import solved_for
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.nlp import Nlp

_SOLVED: StageCache[PointFunctions] = StageCache()


class _Chosen(NamedTuple):
    """Controls that are eliminated from a block of E places.

    Attributes
    ----------
    outputs, inputs : ndarray of int (m,)
        Outputs of the point function that define the controls, and the inputs that are the controls.
    columns, rows : ndarray of int (E, m)
    factors : ndarray (E, m)
        Control over output.
    bounded : ndarray of bool (E m,)
        Whether the control has a bound, which becomes a row.
    """

    outputs: Indices
    inputs: Indices
    columns: Indices
    rows: Indices
    factors: Array
    bounded: Mask


def eliminate_controls(form: Form, nlp: Nlp) -> Form:
    """Eliminate the controls of every block that one row defines.

    A control that one block and no equation reads is no concern of another block. So all are found first, and the form
    is written once: its size and its number of blocks both grow with the number of phases.
    """
    remaining, uses, alone = _remaining(form, nlp), _uses(form), _alone(form)
    pairs = [_pairs(form, block, remaining, uses, alone) for block in form.blocks]
    found = {k: _chosen(form, form.blocks[k], each) for k, each in enumerate(pairs) if each}
    if not found:
        return form
    number = np.full(len(form.lower), -1)
    gone = form.gone.copy()
    row_lower, row_upper = form.row_lower.copy(), form.row_upper.copy()
    for k, each in found.items():
        number[each.columns] = k
        gone[each.columns] = True
        # Rows without bounds are ignored. The rows that define the controls are eliminated in this way.
        row_lower[each.rows], row_upper[each.rows] = -np.inf, np.inf
    row, column, data = entries(form.linear)
    # Linear rows that read u = factor * expression, by the blocks of the controls.
    order = np.argsort(number[column], kind="stable")
    order = order[np.searchsorted(number[column[order]], 0) :]
    ends = np.searchsorted(number[column[order]], list(found), side="right")
    reads = dict(zip(found, np.split(order, ends[:-1]), strict=True))
    n_rows = len(form.row_lower)
    limited = np.concatenate([each.columns.ravel()[each.bounded] for each in found.values()])
    blocks, eliminated, first = [], list(form.eliminated), n_rows
    for k, block in enumerate(form.blocks):
        if k in found:
            own = row[reads[k]], column[reads[k]], data[reads[k]]
            made, expressions = _eliminated(block, found[k], own, first, n_rows + len(limited))
            eliminated.append(Eliminated(k, expressions, found[k].columns, found[k].factors, found[k].rows))
            first += int(found[k].bounded.sum())
        else:
            made = with_empty_rows(block, len(limited))
        blocks.append(made)
    kept = number[column] < 0
    form = replace(
        form,
        blocks=tuple(blocks),
        linear=summed((n_rows, len(form.lower)), (row[kept], column[kept], data[kept])),
        row_lower=row_lower,
        row_upper=row_upper,
        gone=gone,
        eliminated=tuple(eliminated),
    )
    nothing = native(csr_array((len(limited), len(form.lower))))
    return with_rows(form, nothing, form.lower[limited], form.upper[limited], bound_of=limited)


def _remaining(form: Form, nlp: Nlp) -> Mask:
    """Return a mask of the columns of controls that remain unknowns (n_w,): those of robots with passive joints."""
    remaining = np.zeros(len(form.lower), dtype=bool)
    for layout, phase in zip(nlp.layouts, nlp.problem.phases, strict=True):
        robot = phase.robot
        if robot is not None and robot.root == "fixed" and not phase.contacts and robot.nu < robot.nv:
            for run in layout.runs:
                remaining[run.controls] = True
    return remaining


def _chosen(form: Form, block: Block, pairs: Sequence[tuple[int, int]]) -> _Chosen:
    outputs, inputs = np.array(pairs).T
    place = np.arange(block.count)[:, None]
    entry = block.gather.indptr[(place * block.stage.inputs + inputs).ravel()]
    columns = block.gather.indices[entry].reshape(block.count, -1)
    factors = 1.0 / block.gather.data[entry].reshape(block.count, -1)
    row_of, _ = _rows_by_output(block)
    rows = row_of[place * block.stage.outputs + outputs]
    bounded = (np.isfinite(form.lower[columns]) | np.isfinite(form.upper[columns])).ravel()
    return _Chosen(outputs, inputs, columns, rows, factors, bounded)


def _eliminated(
    block: Block, chosen: _Chosen, reads: tuple[Indices, Indices, Array], first: int, n_rows: int
) -> tuple[Block, Indices]:
    """Return a block whose point function has expressions in place of controls, and their numbers among its outputs.

    Parameters
    ----------
    block : Block
    chosen : _Chosen
    reads : tuple of ndarray
        Row, column and value of linear terms of these controls, which become terms of the expressions.
    first, n_rows : int
        Row of the first bound, and the number of rows.
    """
    stage, count, (outputs, inputs) = block.stage, block.count, chosen[:2]
    names = tuple(outputs.tolist()), tuple(inputs.tolist())
    reduced = _SOLVED.get(stage, names, partial(solved_for, stage, *names))
    # The remaining inputs and outputs, and the positions of the expressions among the new outputs.
    kept_in = np.delete(np.arange(stage.inputs), inputs)
    kept_out = np.delete(np.arange(stage.outputs), outputs)
    place = np.arange(count)[:, None]
    expressions = kept_out.size + np.arange(outputs.size)
    width = kept_out.size + outputs.size
    moved = np.full(stage.outputs, -1)
    moved[kept_out] = np.arange(kept_out.size)
    row, column, data = entries(block.scatter)
    output = moved[column % stage.outputs]
    kept = output >= 0
    old = row[kept], column[kept] // stage.outputs * width + output[kept], data[kept]
    at, flat, factors = (place * width + expressions).ravel(), chosen.columns.ravel(), chosen.factors.ravel()
    new = first + np.arange(chosen.bounded.sum()), at[chosen.bounded], factors[chosen.bounded]
    by_column = np.argsort(flat)
    which = by_column[np.searchsorted(flat, reads[1], sorter=by_column)]
    read = reads[0], at[which], reads[2] * factors[which]
    scatter = array(summed((n_rows, count * width), old, new, read))
    gather = _with_rows(block.gather, (place * stage.inputs + kept_in).ravel())
    return replace(block, stage=reduced, gather=gather, scatter=scatter), expressions


def _uses(form: Form) -> Indices:
    """Return how many places, equations and costs read each column (n_w,)."""
    row, column, _ = entries(form.linear)
    equation = (form.row_lower == form.row_upper)[row]
    read = np.concatenate([column[equation], np.flatnonzero(form.cost), *(b.gather.indices for b in form.blocks)])
    return np.bincount(read, minlength=len(form.lower))


def _alone(form: Form) -> Mask:
    """Return which rows state that one output of a block is zero (n_rows,)."""
    alone = (form.nonlinear_entries() == 1) & (np.diff(form.linear.starts) == 0)
    return np.asarray(alone & (form.row_lower == form.row_upper) & (form.row_lower == form.offset))


def _pairs(form: Form, block: Block, remaining: Mask, uses: Indices, alone: Mask) -> Sequence[tuple[int, int]]:
    """Return (output, input) of the controls that can be eliminated."""
    stage = block.stage
    inputs = _private_inputs(form, block, remaining, uses)
    outputs = _private_outputs(block, alone)
    if not inputs.size or not outputs.size:
        return []
    constant = stage.constant_slopes[np.ix_(outputs, inputs)]
    # NaN marks entries that are no constants.
    known = np.where(np.isnan(constant), 1.0, constant) != 0.0
    good = ~np.isnan(constant) & (constant != 0.0)
    single = good & (known.sum(axis=0) == 1)[None, :] & (known.sum(axis=1) == 1)[:, None]
    return [(int(outputs[o]), int(inputs[i])) for o, i in np.argwhere(single)]


def _private_inputs(form: Form, block: Block, remaining: Mask, uses: Indices) -> Indices:
    """Find inputs that are one free column at every place, on which no other place, equation or cost depends."""
    single = np.diff(block.gather.indptr) == 1
    column = np.zeros(single.size, dtype=int)
    column[single] = block.gather.indices[block.gather.indptr[:-1][single]]
    private = single & (uses[column] == 1) & (form.lower[column] < form.upper[column]) & ~remaining[column]
    return np.flatnonzero(private.reshape(block.count, -1).all(axis=0))


def _private_outputs(block: Block, alone: Mask) -> Indices:
    """Find outputs that are, at every place, the only term of an equality row equal to zero."""
    row, single = _rows_by_output(block)
    private = np.all((single & alone[row]).reshape(block.count, -1), axis=0)
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
