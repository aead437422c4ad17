"""Removal of redundant equality constraints.

A constraint on the height of a hand is redundant at ends where fixed joints determine the height. So is a terminal
position of the hand that contains its height. Such equations make a stage rank deficient. A solver with regularised
systems then takes hundreds of iterations instead of twenty.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Mask
from robotraj._util.precision import MET, SAME
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.matrices import entries
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.nlp import Nlp


def remove_satisfied_rows(form: Form, nlp: Nlp) -> Form:
    """Remove the bounds of rows that fixed columns satisfy, and leave those that they contradict.

    Columns of the NLP are fixed where the problem fixes a variable. After ``stretch`` a fixed velocity is no number
    any more, but a multiple of the duration, so rows are removed before. An equation may hold whatever its free columns
    are: a base at rest has no lateral speed, whatever its heading.
    """
    if not _has_redundant_rows(nlp):
        return form
    fixed = (form.lower == form.upper) & ~form.gone
    bounded = (np.isfinite(form.row_lower) | np.isfinite(form.row_upper)) & (form.targets < 0)
    row, column, _ = entries(form.linear)
    bounded[row[~fixed[column]]] = False
    settled = bounded.copy()
    for block in form.blocks:
        row, output, _ = entries(block.scatter)
        settled[row[_free_outputs(block, fixed)[output]]] = False
    held = bounded & ~settled & (form.row_lower == form.row_upper)
    if not settled.any() and not held.any():
        return form
    w = np.where(fixed, form.lower, 0.0)
    values = _values(form, settled, w)
    settled &= (values >= form.row_lower - MET) & (values <= form.row_upper + MET)
    return _without_bounds(form, settled | _holding_whatever_is_free(form, held, fixed, w))


def remove_repeated_rows(form: Form, nlp: Nlp) -> Form:
    """Remove equations of several blocks that are multiples of others at random points."""
    if not _has_redundant_rows(nlp):
        return form
    fixed = (form.lower == form.upper) & ~form.gone
    equations = (form.row_lower == form.row_upper) & (form.targets < 0)
    written = [row[equations[row]] for row in (entries(block.scatter)[0] for block in form.blocks)]
    if sum(row.size > 0 for row in written) < 2:
        return form
    chosen = np.zeros(len(equations), dtype=bool)
    chosen[np.concatenate(written)] = True
    rows = np.flatnonzero(chosen)
    rng = np.random.default_rng(0)
    first, *others = (
        _values(form, chosen, np.where(fixed, form.lower, rng.standard_normal(len(fixed))))[rows] - form.row_lower[rows]
        for _ in range(3)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.array(others) / first
    order = np.argsort(ratios[0], kind="stable")
    near = np.abs(np.diff(ratios[:, order])) <= SAME * np.abs(ratios[:, order[1:]])
    again = np.zeros_like(chosen)
    again[rows[order[1:][near.all(axis=0)]]] = True
    return _without_bounds(form, again) if again.any() else form


def _holding_whatever_is_free(form: Form, equations: Mask, fixed: Mask, w: Array) -> Mask:
    """Return the equations that hold for every value of the free columns.

    A few random values find those that may. That proves nothing, such as beside a path of several pieces: with the
    numbers of the fixed columns, their graphs must be constants.
    """
    held = equations.copy()
    rng = np.random.default_rng(0)
    for _ in range(2):
        if not held.any():
            return held
        drawn = np.where(fixed, w, rng.standard_normal(len(w)))
        held &= np.abs(_values(form, held, drawn) - form.row_lower) <= MET
    for block in form.blocks:
        row, column, _ = entries(block.scatter)
        mine = held[row]
        if mine.any():
            place, output = np.divmod(column[mine], block.stage.outputs)
            held[row[mine][~_constant_outputs(block, place, output, fixed, w)]] = False
    return held


def _constant_outputs(block: Block, places: Array, outputs: Array, fixed: Mask, w: Array) -> Mask:
    """Which outputs, each at its place, have graphs without free columns once the fixed ones are numbers."""
    stage, free, values = block.stage, _free_inputs(block, fixed), block.places(w)
    constant = np.zeros(len(places), dtype=bool)
    if not isinstance(stage.v, ca.SX):
        return constant
    known = {symbol.element_hash() for symbol in ca.symvar(stage.c)}
    for place in np.unique(places).tolist():
        mine = np.flatnonzero(places == place)
        inputs = np.flatnonzero(~free[place]).tolist()
        graphs = ca.substitute(stage.y[outputs[mine].tolist()], stage.v[inputs], ca.DM(values[inputs, place]))
        constant[mine] = [
            all(symbol.element_hash() in known for symbol in ca.symvar(each)) for each in ca.vertsplit(graphs)
        ]
    return constant


def _has_redundant_rows(nlp: Nlp) -> bool:
    """Whether a problem may have redundant equations: constraints, contacts and links alone have them."""
    return bool(nlp.problem.bound_links) or any(phase.constraints or phase.contacts for phase in nlp.problem.phases)


def _without_bounds(form: Form, rows: Mask) -> Form:
    row_lower, row_upper = form.row_lower.copy(), form.row_upper.copy()
    row_lower[rows], row_upper[rows] = -np.inf, np.inf
    return replace(form, row_lower=row_lower, row_upper=row_upper)


def _free_outputs(block: Block, fixed: Mask) -> Mask:
    """Which outputs of which places read a free column, (n_y E,)."""
    stage = block.stage
    reads = np.zeros((stage.outputs, stage.inputs))
    reads[stage.jacobian_pattern] = 1.0
    return np.asarray(_free_inputs(block, fixed) @ reads.T > 0.0).ravel()


def _free_inputs(block: Block, fixed: Mask) -> Mask:
    """Which inputs of every place read a free column, (E, n_v)."""
    row, column, _ = entries(block.gather)
    free = np.zeros(block.gather.shape[0], dtype=bool)
    free[row[~fixed[column]]] = True
    return free.reshape(block.count, block.stage.inputs)


def _values(form: Form, chosen: Mask, w: Array) -> Array:
    """Return the values of rows at w, correct where they are chosen."""
    values = form.linear @ w + form.offset
    for block in form.blocks:
        row, column, data = entries(block.scatter)
        mine = chosen[row]
        if not mine.any():
            continue
        place, output = np.divmod(column[mine], block.stage.outputs)
        number = np.zeros(block.count, dtype=int)
        number[place] = 1
        places = np.flatnonzero(number)
        number[places] = np.arange(places.size)
        outputs = block.stage.evaluate("function", block.places(w)[:, places], block.constants[:, places])
        np.add.at(values, row[mine], data[mine] * outputs[output, number[place]])
    return np.asarray(values)
