"""The numbers of a problem in stages, the input of the compiled solver.

    y = [u_0, x_0, u_1, x_1, ...],   v_b = G_b y + g_b,   Y_b = f_b(v_b, c_b)
    rows      = L y + l + sum_b S_b vec(Y_b),   in the order dynamics, path equalities, inequalities, stage after stage
    objective = c' y + c0 + sum_b s_b' cost_b

with derivatives by the chain rule, as sparse combinations of the nonzeros of the blocks' derivatives.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array, Indices, Mask
from robotraj._util.values import dataclass
from robotraj.native.build import load_native
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.matrices import Entries, array, entries, entries_of, native, summed
from robotraj.solvers.stagewise.order import Order
from robotraj.solvers.stagewise.slots import Slots
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import scaled

if TYPE_CHECKING:
    from robotraj.native import Chain, Csr, Stacked


@dataclass(frozen=True, eq=False)
class BlockProgram:
    """One block of a program.

    Attributes
    ----------
    block : Block
        Its gather reads y and its scatter writes the program's rows.
    shift : ndarray (n_v E,)
        g, the offset of the gather.
    jacobian : Csr (nonzeros of the Jacobian, nonzeros of the places' Jacobians)
    hessian : Stacked (nonzeros of the Hessian, nonzeros of the places' Hessians)
    gradient : Csr (n_y, n_v E) or None
        None where the block has no cost.
    """

    block: Block
    shift: Array
    jacobian: Csr
    hessian: Stacked
    gradient: Csr | None


@dataclass(frozen=True, eq=False)
class StageProgram:
    """A problem in stages; see the module.

    Attributes
    ----------
    nu, nx, equalities, inequalities : ndarray of int (stages,)
    linear, shift : Csr (n_rows, n_y), ndarray (n_rows,)
        L and l; dynamics are F(u_k, x_k) - x_{k+1} = 0.
    cost, constant : ndarray (n_y,), float
        c and c0.
    jacobian : (ndarray of int, ndarray of int)
        Rows and columns of the nonzeros, without those of x_{k+1} in the dynamics.
    jacobian_constant : ndarray
        Linear part of the nonzeros.
    hessian : (ndarray of int, ndarray of int)
        Rows and columns of the upper triangle's nonzeros.
    blocks : tuple of BlockProgram
    lower, upper : ndarray (inequalities,)
    form_rows : ndarray of int (n_rows,)
        The form's row of each path row, -1 for dynamics and bounds.
    bound_columns : ndarray of int (n_rows,)
        The column whose bound a row is, -1 for all others.
    groups : ndarray of int32 (k, n_y + n_rows), optional
        Orders in which a sparse factorisation may eliminate columns and rows: groups by ascending number.
    """

    nu: Indices
    nx: Indices
    equalities: Indices
    inequalities: Indices
    linear: Csr
    shift: Array
    cost: Array
    constant: float
    jacobian: tuple[Indices, Indices]
    jacobian_constant: Array
    hessian: tuple[Indices, Indices]
    blocks: tuple[BlockProgram, ...]
    lower: Array
    upper: Array
    form_rows: Indices
    bound_columns: Indices
    groups: NDArray[np.int32] | None = None


@dataclass(frozen=True, eq=False)
class _Rows:
    """Path rows and bounds in the order of the program, after the dynamics."""

    form_rows: Indices
    columns: Indices
    stages: Indices
    equal: Mask
    lower: Array
    upper: Array


def build(form: Form, order: Order, slots: Slots, known: Mask, values: Array) -> StageProgram:
    """Write the program of a form whose columns have slots.

    Parameters
    ----------
    form, order, slots : Form, Order, Slots
    known : ndarray of bool (n_w,)
        Columns fixed at ``values``.
    values : ndarray (n_w,)
    """
    path = _rows(form, order, slots, known)
    dynamics = len(slots.carried)
    n_rows, n_y = dynamics + path.stages.size, slots.matrix.columns
    number = _numbers(form, path, dynamics)
    over_slots, shift = _over_slots(form, order, slots, known, values, path)
    linear = over_slots @ slots.matrix

    blocks, chains = [], []
    for block, places in zip(form.blocks, order.places, strict=True):
        reads, fixed = _reads(block, known, values)
        of_slots = _at_places(reads, places, slots)
        gather, offset = of_slots @ slots.matrix, of_slots @ slots.offset
        row, output, data = entries(block.scatter)
        row, mine = number[row], number[row] >= 0
        scatter = array(summed((n_rows, block.scatter.shape[1]), (row[mine], output[mine], data[mine])))
        blocks.append((replace(block, gather=array(gather), scatter=scatter), fixed + offset))
        chains.append(_chain(blocks[-1][0], reads, gather, places))
    module = load_native()
    starts = np.append(0, np.cumsum(slots.nu + slots.nx))
    # Dynamics of stage s make the states of stage s + 1.
    stage_of_row = np.append(np.repeat(np.arange(order.stages - 1), slots.nx[1:]), path.stages)
    pattern, constants, jacobians = module.jacobian_chain(
        linear, chains, slots.matrix, slots.base - slots.first, starts, stage_of_row
    )
    curvature, _, hessians = module.hessian_chain(chains, starts)
    programs = []
    for (block, offset), jacobian, hessian in zip(blocks, jacobians, hessians, strict=True):
        gradient = None
        if block.costs:
            gradient = native(scaled(block.gather, rows=np.repeat(block.weights, block.stage.inputs))).transposed()
        programs.append(BlockProgram(block, offset, jacobian, hessian, gradient))

    # x_{k+1}, the slot (c, s + 1), has the coefficient -1 in the dynamics. The list of nonzeros does not contain it.
    row, column, data = entries_of(slots.matrix, slots.carried[:, 1])
    cost, base = _cost(form, slots, known, values)
    stages = order.stages
    return StageProgram(
        slots.nu,
        slots.nx,
        np.bincount(path.stages[path.equal], minlength=stages),
        np.bincount(path.stages[~path.equal], minlength=stages),
        summed((n_rows, n_y), entries(linear), (row, column, -data)).pruned(),
        shift,
        cost,
        base,
        pattern,
        constants,
        curvature,
        tuple(programs),
        path.lower[~path.equal],
        path.upper[~path.equal],
        np.append(np.full(dynamics, -1), path.form_rows),
        np.append(np.full(dynamics, -1), path.columns),
    )


def with_values(
    program: StageProgram, form: Form, order: Order, slots: Slots, known: Mask, values: Array
) -> StageProgram | None:
    """Return the program of a form that differs only in bounds, offsets, constants and known values.

    Combinations and patterns are those of ``program``. None is returned where its rows differ.
    """
    path = _rows(form, order, slots, known)
    dynamics = len(slots.carried)
    mine = program.form_rows[dynamics:], program.bound_columns[dynamics:]
    if not all(map(np.array_equal, mine, (path.form_rows, path.columns))) or path.equal.sum() != sum(
        program.equalities
    ):
        return None
    _, shift = _over_slots(form, order, slots, known, values, path)
    blocks = []
    for part, block, places in zip(program.blocks, form.blocks, order.places, strict=True):
        reads, fixed = _reads(block, known, values)
        offset = _at_places(reads, places, slots) @ slots.offset
        blocks.append(replace(part, block=replace(part.block, constants=block.constants), shift=fixed + offset))
    _, constant = _cost(form, slots, known, values)
    lower, upper = path.lower[~path.equal], path.upper[~path.equal]
    return replace(program, shift=shift, constant=constant, blocks=tuple(blocks), lower=lower, upper=upper)


def _rows(form: Form, order: Order, slots: Slots, known: Mask) -> _Rows:
    open_rows = np.isfinite(form.row_lower) | np.isfinite(form.row_upper)
    open_rows[slots.used] = False
    rows = np.flatnonzero(open_rows)
    alive = (slots.last >= slots.first) & ~known
    columns = np.flatnonzero(alive & (np.isfinite(form.lower) | np.isfinite(form.upper)))
    form_rows = np.append(rows, np.full(columns.size, -1))
    every = np.append(np.full(rows.size, -1), columns)
    stages = np.append(order.rows[rows], slots.last[columns])
    lower = np.append(form.row_lower[rows], form.lower[columns])
    upper = np.append(form.row_upper[rows], form.upper[columns])
    ranked = np.lexsort((np.arange(stages.size), stages, lower != upper))
    equal = (lower == upper)[ranked]
    return _Rows(form_rows[ranked], every[ranked], stages[ranked], equal, lower[ranked], upper[ranked])


def _numbers(form: Form, path: _Rows, dynamics: int) -> Indices:
    """Return the row of the program for each row of the form, -1 for none."""
    number = np.full(len(form.row_lower), -1)
    kept = path.form_rows >= 0
    number[path.form_rows[kept]] = dynamics + np.flatnonzero(kept)
    return number


def _over_slots(form: Form, order: Order, slots: Slots, known: Mask, values: Array, path: _Rows) -> tuple[Csr, Array]:
    """Linear part of the program's rows over slots, and their offsets; path equalities are zero."""
    dynamics = len(slots.carried)
    n_rows = dynamics + path.stages.size
    read, shift = _linear(form, order, slots, known, values, _numbers(form, path, dynamics), n_rows)
    bounds = np.flatnonzero(path.columns >= 0)
    at_bounds = slots.at(path.columns[bounds], path.stages[bounds])
    rows = np.concatenate([np.arange(dynamics), dynamics + bounds])
    taken = rows, np.concatenate([slots.carried[:, 0], at_bounds]), np.ones(rows.size)
    over_slots = summed((n_rows, slots.matrix.rows), read, taken).pruned()
    shift += over_slots @ slots.offset
    shift[dynamics:] -= np.where(path.equal, path.lower, 0.0)
    return over_slots, shift


def _linear(
    form: Form, order: Order, slots: Slots, known: Mask, values: Array, number: Indices, n_rows: int
) -> tuple[Entries, Array]:
    """Rows of the form over slots, and the contributions of known columns and offsets."""
    row, column, data = entries(form.linear)
    kept = number[row] >= 0
    row, column, data = row[kept], column[kept], data[kept]
    shift = np.zeros(n_rows)
    mine = np.flatnonzero(number >= 0)
    shift[number[mine]] = form.offset[mine]
    fixed = known[column]
    np.add.at(shift, number[row[fixed]], data[fixed] * values[column[fixed]])
    row, column, data = row[~fixed], column[~fixed], data[~fixed]
    at = slots.at(column, order.rows[row])
    return (number[row], at, data), shift


def _reads(block: Block, known: Mask, values: Array) -> tuple[Csr, Array]:
    """Return the gather of unknown columns, and the sum of the contributions of known ones."""
    row, column, data = entries(block.gather)
    fixed = known[column]
    offset = np.zeros(block.gather.shape[0])
    np.add.at(offset, row[fixed], data[fixed] * values[column[fixed]])
    return summed(block.gather.shape, (row[~fixed], column[~fixed], data[~fixed])), offset


def _at_places(reads: Csr, places: Indices, slots: Slots) -> Csr:
    """Return a gather of columns as one of slots, in the stages of the places."""
    row, column, data = entries(reads)
    at = slots.at(column, places[row // (reads.rows // places.size)])
    return summed((reads.rows, slots.matrix.rows), (row, at, data))


def _chain(block: Block, reads: Csr, gather: Csr, places: Indices) -> Chain:
    stage = block.stage
    patterns = (np.asarray(side, dtype=np.int64) for side in (*stage.jacobian_pattern, *stage.hessian_pattern))
    made: Chain = load_native().Chain(
        block.count, stage.inputs, stage.outputs, *patterns, native(block.scatter), reads, gather, places
    )
    return made


def _cost(form: Form, slots: Slots, known: Mask, values: Array) -> tuple[Array, float]:
    costed = np.flatnonzero((form.cost != 0.0) & ~known)
    base = form.constant + float(form.cost[known] @ values[known])
    if not costed.size:
        return np.zeros(slots.matrix.columns), base
    weights = np.zeros(slots.matrix.rows)
    weights[slots.at(costed, slots.last[costed])] = form.cost[costed]
    return slots.matrix.transposed() @ weights, base + float(weights @ slots.offset)
