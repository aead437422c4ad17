"""Multipliers of one program as a start for another, with added rows or other ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.solvers.stagewise.reduction import Reduction

Keys = NDArray[np.int64]
KINDS = 8
"""Keys are KINDS * number + kind."""


def carried_over(known: Reduction, multipliers: Array, new: Reduction) -> Array:
    """Return multipliers of a program for the equal rows of another one, zero for all other rows.

    Parameters
    ----------
    known : Reduction
    multipliers : ndarray (n_rows,)
        Multipliers of the rows of its program.
    new : Reduction
        Reduction of an NLP whose first columns and rows are those of the known one.
    """
    old_keys, new_keys = _keys(known), _keys(new)
    order = np.argsort(old_keys)
    at = np.minimum(np.searchsorted(old_keys[order], new_keys), old_keys.size - 1)
    found = order[at]
    return np.where(old_keys[found] == new_keys, multipliers[found], 0.0)


def _keys(reduction: Reduction) -> Keys:
    """Return a key for every row of a program: dynamics of a state, a row of the NLP or one side of it, a bound."""
    form, program, slots = reduction.form, reduction.program, reduction.slots
    rows, columns = program.form_rows, program.bound_columns
    carried = slots.carried[:, 0]
    first_slot = np.argsort(slots.base, kind="stable")
    column = first_slot[np.searchsorted(slots.base[first_slot], carried, side="right") - 1]
    stage = slots.first[column] + carried - slots.base[column]
    keys = np.empty(rows.size, dtype=np.int64)
    keys[: carried.size] = KINDS * (column.astype(np.int64) * len(program.nu) + stage)
    path = rows >= 0
    mine = rows[path]
    above = ~np.isfinite(form.row_lower[mine])
    limits, bounds = form.limit_of[mine], form.bound_of[mine]
    own = (limits == mine) | (bounds < 0)
    keys[path] = np.where(own, KINDS * np.where(limits == mine, mine, limits) + 1 + above, KINDS * bounds + 3 + above)
    fixed = columns >= 0
    keys[fixed] = KINDS * columns[fixed].astype(np.int64) + 5
    return keys
