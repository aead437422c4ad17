"""Which stage every column, row and place belongs to.

Stage s stands for interval s of the plan; after the last interval of a phase comes one stage for its last knot, which
also holds the link to the next phase. A column is introduced in the first stage that reads it and carried along, as a
state, to the last one. A knot's columns live in two stages, an interval's own in one, durations and parameters in all
of their phase; rows that couple more, such as a periodic link, make their columns live longer.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.sparse import csr_array
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.matrices import entries, summed
from robotraj.transcription.layout import PhaseLayout

if TYPE_CHECKING:
    from robotraj.native import Csr

Indices = NDArray[np.int_]
EVER = np.iinfo(np.int64).max // 2


@dataclass(frozen=True, eq=False)
class Order:
    """Stages of columns, rows and places.

    Attributes
    ----------
    stages : int
    first, last : ndarray of int (n_w,)
        Stages in which a column lives; first > last where nothing reads it.
    rows : ndarray of int (n_rows,)
        Stage of every row.
    places : tuple of ndarray of int (E,)
        Stage of every place, by block.
    """

    stages: int
    first: Indices
    last: Indices
    rows: Indices
    places: tuple[Indices, ...]

    def alike(self, other: Order) -> bool:
        """Whether everything has the same stage."""
        mine, its = ((each.first, each.last, each.rows, *each.places) for each in (self, other))
        return self.stages == other.stages and len(mine) == len(its) and all(map(np.array_equal, mine, its))


def homes(
    layouts: Sequence[PhaseLayout], links: Sequence[Indices], ends: Sequence[int], n_w: int
) -> tuple[Indices, Indices, int]:
    """Stages among which each column may be read at no cost, (n_w,) twice, and the number of stages.

    Columns of states of added rows have no stage yet: their first stage is beyond their last.

    Parameters
    ----------
    layouts : sequence of PhaseLayout
    links : sequence of ndarray of int
        Columns of the unknowns of every link.
    ends : sequence of int
        The phase that each link follows.
    n_w : int
    """
    low, high = np.full(n_w, EVER), np.full(n_w, -1)
    stage = 0
    offsets = []
    for layout in layouts:
        offsets.append(stage)
        count = layout.count
        for run in layout.runs:
            at = stage + run.which
            for columns in (run.states, run.algebraic, run.controls, run.corrections, run.left, run.right):
                if columns.size:
                    flat = columns.reshape(len(at), -1)
                    every = np.broadcast_to(at[:, None], flat.shape)
                    np.minimum.at(low, flat, every)
                    np.maximum.at(high, flat, every)
        final = layout.runs[-1]
        last_node = [layout.knots[-1]]
        if final.scheme.nodes[-1] == 1.0:
            last_node.append(final.algebraic[-1, -1])
        if final.scheme.control_sites[-1] == 1.0:
            last_node.append(final.controls[-1, -1])
        high[np.concatenate(last_node)] = stage + count
        if stage:
            low[layout.knots[0]] = stage - 1
        for scalar in (layout.t0, layout.duration, *layout.parameters):
            if scalar.column is not None:
                low[scalar.column], high[scalar.column] = max(stage - 1, 0), EVER
        stage += count + 1
    for columns, end in zip(links, ends, strict=True):
        low[columns] = high[columns] = offsets[end] + layouts[end].count
    return low, high, stage


def order(form: Form, low: Indices, high: Indices, stages: int, constant: NDArray[np.bool_]) -> Order:
    """Assign stages.

    Parameters
    ----------
    form : Form
    low, high : ndarray of int (n_w,)
        As from ``homes``.
    stages : int
    constant : ndarray of bool (n_w,)
        Columns whose value is known: they live nowhere.
    """
    patterns = [_pattern(block.gather) for block in form.blocks]
    n_rows, n_w = form.linear.rows, form.linear.columns
    readers = [_pattern(form.linear)]
    for block, (at, column) in zip(form.blocks, patterns, strict=True):
        # Which columns each row reads through the block's places.
        reach = summed((block.count, n_w), (at // block.stage.inputs, column, np.ones(at.size)))
        row, output = _pattern(block.scatter)
        through = summed((n_rows, block.count), (row, output // block.stage.outputs, np.ones(row.size)))
        readers.append(_pattern(through @ reach))
    row_of, column_of = (np.concatenate(parts) for parts in zip(*readers, strict=True))
    real = (np.isfinite(form.row_lower) | np.isfinite(form.row_upper))[row_of]
    row_of, column_of = row_of[real], column_of[real]
    low, high = _housed(row_of, column_of, n_rows, low, high, constant)
    places = []
    for block, (row, column) in zip(form.blocks, patterns, strict=True):
        places.append(_choose(row // block.stage.inputs, column, block.count, low, high, constant))
    rows = _choose(row_of, column_of, len(form.row_lower), low, high, constant)
    first, last = np.full(len(low), EVER), np.full(len(low), -1)
    _live(first, last, column_of, rows[row_of])
    for block, (at, column), stage in zip(form.blocks, patterns, places, strict=True):
        _live(first, last, column, stage[at // block.stage.inputs])
    costed = np.flatnonzero(form.cost)
    _live(first, last, costed, np.minimum(high[costed], stages - 1))
    first[constant], last[constant] = EVER, -1
    return Order(stages, first, last, rows, tuple(places))


def _pattern(matrix: Csr | csr_array) -> tuple[Indices, Indices]:
    rows, columns, _ = entries(matrix)
    return rows, columns


def _live(first: Indices, last: Indices, columns: Indices, stages: Indices) -> None:
    np.minimum.at(first, columns, stages)
    np.maximum.at(last, columns, stages)


def _housed(
    rows: Indices, columns: Indices, count: int, low: Indices, high: Indices, constant: NDArray[np.bool_]
) -> tuple[Indices, Indices]:
    """Put columns without a stage into that of the first row that reads them beside columns of an interval.

    In that row the state of an added row is evaluated on the interval's polynomial. Its path row reads no other column:
    it would stand in the first stage, and carry the state through all stages between.
    """
    strays = low > high
    if not strays.any():
        return low, high
    low, high = np.where(strays, 0, low), np.where(strays, EVER, high)
    settled = (high < EVER)[columns] & ~constant[columns]
    stages = _choose(rows[settled], columns[settled], count, low, high, constant)
    known = np.zeros(count, dtype=bool)
    known[rows[settled]] = True
    beside = strays[columns] & known[rows]
    home = np.full(len(low), EVER)
    np.minimum.at(home, columns[beside], stages[rows[beside]])
    found = home < EVER
    low[found] = high[found] = home[found]
    return low, high


def _choose(
    group: Indices, columns: Indices, count: int, low: Indices, high: Indices, constant: NDArray[np.bool_]
) -> Indices:
    """Stage of every group of columns: the last in which all are at home, else the first in which the latest is."""
    free = ~constant[columns]
    group, columns = group[free], columns[free]
    latest, earliest = np.zeros(count, dtype=int), np.full(count, EVER)
    np.maximum.at(latest, group, low[columns])
    np.minimum.at(earliest, group, high[columns])
    earliest[earliest >= EVER] = latest[earliest >= EVER]
    return np.maximum(latest, earliest)
