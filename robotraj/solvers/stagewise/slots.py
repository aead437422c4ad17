"""Columns in their stages: each is a control, a state carried over, or an expression of the stage.

A slot is a column in one of its stages. In its first stage it is a control. If a linear row defines it (a defect whose
x_j is the column), it is an expression of the variables of that stage. In all later stages it is a state:

    slots = X y + x0,    y = [u_0, x_0, u_1, x_1, ...].
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices, Mask
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.matrices import entries_of, summed
from robotraj.solvers.stagewise.order import Order

if TYPE_CHECKING:
    from robotraj.native import Csr


@dataclass(frozen=True, eq=False)
class Slots:
    """The slots of all columns.

    Attributes
    ----------
    first, last : ndarray of int (n_w,)
        First and last stage of a column.
    base : ndarray of int (n_w,)
        Number of a column's first slot.
    nu, nx : ndarray of int (stages,)
    matrix, offset : Csr (n_slots, n_y), ndarray (n_slots,)
        X and x0.
    used : ndarray of int
        Rows of the form that became definitions.
    variables : ndarray of int (n_y,)
        The column of every entry of y.
    carried : ndarray of int (m, 2)
        Slots (c, s) and (c, s + 1) of every state, in the order of the states of stages 1, 2, ...
    """

    first: Indices
    last: Indices
    base: Indices
    nu: Indices
    nx: Indices
    matrix: Csr
    offset: Array
    used: Indices
    variables: Indices
    carried: Indices

    def at(self, columns: Indices, stages: Indices) -> Indices:
        """Return the slots of columns in some of their stages."""
        return np.asarray(self.base[columns] + stages - self.first[columns])


def make_slots(form: Form, order: Order, known: Mask, values: Array) -> Slots:
    """Assign a number and an expression to every slot.

    Parameters
    ----------
    form : Form
    order : Order
    known : ndarray of bool (n_w,)
        Columns whose ``values`` are fixed.
    values : ndarray (n_w,)
    """
    alive = order.last >= order.first
    life = np.where(alive, order.last - order.first + 1, 0)
    base = np.concatenate([[0], np.cumsum(life)[:-1]])
    total = int(life.sum())
    column = np.repeat(np.arange(life.size), life)
    stage = order.first[column] + np.arange(total) - base[column]
    begins = stage == order.first[column]
    used = _without_cycles(form, order, _defining(form, order, alive))
    defined = np.zeros(life.size, dtype=bool)
    defined[form.targets[used]] = True
    is_control = begins & ~defined[column]
    free = np.flatnonzero(is_control | ~begins)
    ranked = free[np.lexsort((column[free], ~begins[free], stage[free]))]
    nu = np.bincount(stage[is_control], minlength=order.stages)
    nx = np.bincount(stage[~begins], minlength=order.stages)

    chain, start = _definitions(form, order, base, total, used, known, values)
    variable = np.full(total, -1)
    variable[ranked] = np.arange(ranked.size)
    matrix = chain.resolved(variable, ranked.size)
    later = ranked[~begins[ranked]]
    return Slots(
        order.first,
        order.last,
        base,
        nu,
        nx,
        matrix,
        _settled(chain, start),
        used,
        column[ranked],
        np.stack([later - 1, later], axis=1),
    )


def with_values(slots: Slots, form: Form, order: Order, known: Mask, values: Array) -> Slots:
    """Return the slots of a form that differs only in bounds, offsets and known values: only x0 changes."""
    chain, start = _definitions(form, order, slots.base, slots.matrix.rows, slots.used, known, values)
    return replace(slots, offset=_settled(chain, start))


def _settled(chain: Csr, start: Array) -> Array:
    """Solve x0 = start + chain x0, where the definitions have no cycles."""
    offset = start
    while not np.array_equal(offset, further := start + chain @ offset, equal_nan=True):
        offset = further
    return offset


def _definitions(
    form: Form, order: Order, base: Indices, total: int, used: Indices, known: Mask, values: Array
) -> tuple[Csr, Array]:
    """Return definitions of slots by slots of the same stage, slots = chain slots + start; other rows are zero."""
    # w_c = (bound - offset - sum of the others) / coefficient of w_c, for each row used.
    row, read, data = entries_of(form.linear, used)
    target = form.targets[used]
    place = order.rows[used]
    own = read == target[row]
    pivot = np.zeros(used.size)
    pivot[row[own]] = data[own]
    constant = known[read]
    shift = form.row_lower[used] - form.offset[used]
    np.subtract.at(shift, row[constant], data[constant] * values[read[constant]])
    start = np.zeros(total)
    slot_of_row = base[target] + place - order.first[target]
    other = ~own & ~constant
    row, read, data = row[other], read[other], data[other]
    chain = summed((total, total), (slot_of_row[row], base[read] + place[row] - order.first[read], -data / pivot[row]))
    start[slot_of_row] = shift / pivot
    return chain, start


def _without_cycles(form: Form, order: Order, used: Indices) -> Indices:
    """Drop rows whose targets define each other, as the states of a linear system do; they remain equalities."""
    row, read, _ = entries_of(form.linear, used)
    target = form.targets[used]
    definer = np.full(len(form.lower), -1)
    definer[target] = np.arange(used.size)
    # In a later stage the column is a variable.
    inside = (definer[read] >= 0) & (read != target[row]) & (order.first[read] == order.rows[used][row])
    row, by = row[inside], definer[read[inside]]
    # Rows that depend on no open definition are closed, until all open rows are in a cycle or depend on one.
    open_rows = np.ones(used.size, dtype=bool)
    while True:
        waiting = np.zeros(used.size, dtype=bool)
        waiting[row[open_rows[row] & open_rows[by]]] = True
        if np.array_equal(waiting, open_rows):
            return used[~open_rows]
        open_rows = waiting


def _defining(form: Form, order: Order, alive: Mask) -> Indices:
    """Return the rows that define their target in its first stage, one for each target."""
    rows = np.flatnonzero((form.targets >= 0) & (form.row_lower == form.row_upper) & (form.nonlinear_entries() == 0))
    target = form.targets[rows]
    rows = rows[alive[target] & (order.first[target] == order.rows[rows])]
    _, once = np.unique(form.targets[rows], return_index=True)
    return np.sort(rows[once])
