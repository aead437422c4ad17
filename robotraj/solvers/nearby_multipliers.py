"""Multipliers of inequality rows from those on another mesh of the same problem.

A row at the place tau in [0, 1] of an interval of length h has a multiplier of about h z(t). The density z is smooth
between switches. For rows of the same name, joint, place and side, z is interpolated over time and multiplied by the
length of the new interval. The solver estimates the multipliers of the equations from these.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.precision import MET, ROUND_OFF, SAME
from robotraj.solvers.formulation import Formulation
from robotraj.solvers.stagewise.reduction import Reduction
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Scalars
from robotraj.transcription.schemes.mesh import MovingMesh

PLACES = round(1.0 / MET)
"""Number of places in an interval that rows of two meshes share or do not."""


def interpolated(known: Formulation, lam: Array, new: Formulation) -> tuple[Array, Array] | None:
    """Return multipliers of the lower and upper bounds of a program's inequality rows, none negative.

    Parameters
    ----------
    known : Formulation
        Formulation on another mesh.
    lam : ndarray (n_rows,)
        Multipliers of its program's rows.
    new : Formulation

    Returns
    -------
    (ndarray, ndarray) or None
        None where knots move, or where no row has a counterpart.
    """
    layouts = (*known.nlp.layouts, *new.nlp.layouts)
    if any(isinstance(layout.mesh, MovingMesh) for layout in layouts):
        return None
    source, target = _table(known), _table(new)
    lower, upper = np.zeros(target.count), np.zeros(target.count)
    found = False
    density = lam[lam.size - source.count :] * source.factor / source.length
    for key, here in target.groups.items():
        there = source.groups.get(key)
        if there is None:
            continue
        found = True
        for side, sign in ((lower, -1.0), (upper, 1.0)):
            own = np.interp(target.middle[here], source.middle[there], np.maximum(sign * density[there], 0.0))
            side[here] = own * target.length[here] / target.factor[here]
    return (lower, upper) if found else None


class _Table:
    """Inequality rows of a program: their keys, middles and lengths of their intervals, factors to physical units."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.middle, self.length, self.factor = np.zeros(count), np.ones(count), np.ones(count)
        self.groups: dict[Hashable, Indices] = {}


def _table(formulation: Formulation) -> _Table:
    """Group the inequality rows of a program by quantity, place in their intervals and side."""
    program, nlp = formulation.program, formulation.nlp
    count = program.lower.size
    table = _Table(count)
    first = program.form_rows.size - count
    rows, columns = program.form_rows[first:].copy(), program.bound_columns[first:].copy()
    if isinstance(formulation, Reduction):
        form = formulation.form
        of_form = np.flatnonzero(rows >= 0)
        form_rows = rows[of_form]
        columns[of_form], rows[of_form] = form.bound_of[form_rows], form.limit_of[form_rows]
    sides = np.isfinite(program.lower) + 2 * np.isfinite(program.upper)
    keys = np.zeros((count, 3), dtype=np.int64)
    for kind, numbers, scalars, factors in (
        (0, rows, nlp.rows, nlp.row_scale),
        (1, columns, nlp.variables, 1.0 / nlp.scale),
    ):
        chosen = np.flatnonzero(numbers >= 0)
        if chosen.size:
            keys[chosen, 0] = 2 * scalars.meaning[numbers[chosen]] + kind
            _place(table, keys, chosen, numbers[chosen], scalars, nlp)
            table.factor[chosen] = factors[numbers[chosen]]
    ranks = int(keys[:, 2].max(initial=0)) + 1
    codes = ((keys[:, 0] * (PLACES + 1) + keys[:, 1]) * ranks + keys[:, 2]) * 4 + sides
    ordered = np.lexsort((table.middle, codes))
    ends = np.flatnonzero(np.diff(codes[ordered])) + 1
    for group in np.split(ordered, ends) if count else ():
        meaning, place, rank = keys[group[0]].tolist()
        entries = nlp.variables.entries if meaning % 2 else nlp.rows.entries
        table.groups[meaning % 2, entries[meaning // 2], place, rank, int(sides[group[0]])] = group
    return table


def _place(table: _Table, keys: Indices, chosen: Indices, numbers: Indices, scalars: Scalars, nlp: Nlp) -> None:
    """Write the times and interval lengths of rows or columns of the NLP, their places, and their ranks at a place."""
    fraction, meaning = scalars.fraction[numbers], scalars.meaning[numbers]
    phases = np.array([entry.phase for entry in scalars.entries], dtype=int)[meaning]
    for phase, layout in enumerate(nlp.layouts):
        own = phases == phase
        knots, at = layout.mesh.knots, fraction[own]
        lengths = np.diff(knots)
        interval = np.clip(np.searchsorted(knots, at + ROUND_OFF, side="right") - 1, 0, lengths.size - 1)
        place = (at - knots[interval]) / lengths[interval]
        at_knot = np.abs(place - 0.5) > 0.5 - SAME
        # A knot between two intervals has half of the length of each.
        beside = 0.5 * (np.append(lengths[0], lengths) + np.append(lengths, lengths[-1]))
        knot = np.clip(np.searchsorted(knots, at - ROUND_OFF), 0, lengths.size)
        table.length[chosen[own]] = np.where(at_knot, beside[knot], lengths[interval])
        table.middle[chosen[own]] = at
        keys[chosen[own], 1] = np.where(at_knot, 0, np.round(place * PLACES))
    ranked = np.lexsort((numbers, fraction, meaning))
    first = np.append(True, (np.diff(meaning[ranked]) != 0) | (np.diff(fraction[ranked]) != 0))
    begins = np.maximum.accumulate(np.where(first, np.arange(first.size), 0))
    keys[chosen[ranked], 2] = np.arange(first.size) - begins
