"""The stage of every column, row and place.

Stage s belongs to interval s of the plan. After the last interval of a phase, one stage belongs to its last knot and
to the link to the next phase. A column is introduced in the first stage that depends on it and carried over, as a
state, to the last one. Columns of a knot are in two stages, those of an interval in one, durations and parameters in
all stages of their phase. Rows that couple more stages, such as a periodic link, carry their columns through all of
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Indices
from robotraj._util.sparse import csr_array
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.matrices import entries, summed
from robotraj.transcription.layout import PhaseLayout

if TYPE_CHECKING:
    from robotraj.native import Csr

EVER = np.iinfo(np.int32).max
"""Number beyond all stages."""


@dataclass(frozen=True, eq=False)
class Order:
    """Stages of columns, rows and places.

    Attributes
    ----------
    stages : int
    first, last : ndarray of int (n_w,)
        First and last stage of a column; first > last where nothing depends on it.
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
        first, second = ((each.first, each.last, each.rows, *each.places) for each in (self, other))
        return self.stages == other.stages and len(first) == len(second) and all(map(np.array_equal, first, second))


def allowed_stages(
    layouts: Sequence[PhaseLayout], links: Sequence[Indices], ends: Sequence[int], n_w: int
) -> tuple[Indices, Indices, int]:
    """Return the first and last stage that each column has by its place in the layout, and the number of stages.

    Columns of states of added rows have no stage yet; their first stage is beyond their last.

    Parameters
    ----------
    layouts : sequence of PhaseLayout
    links : sequence of ndarray of int
        Columns of the unknowns of every link.
    ends : sequence of int
        The phase before each link.
    n_w : int
        Number of columns.

    Returns
    -------
    low, high : ndarray of int (n_w,)
    stages : int
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
        First and last stages by ``allowed_stages``.
    stages : int
    constant : ndarray of bool (n_w,)
        Columns whose value is known; they have no stages.

    Returns
    -------
    Order
    """
    patterns = [_pattern(block.gather) for block in form.blocks]
    n_rows, n_w = form.linear.rows, form.linear.columns
    readers = [_pattern(form.linear)]
    for block, (at, column) in zip(form.blocks, patterns, strict=True):
        # The columns on which each row depends through the places of the block.
        reach = summed((block.count, n_w), (at // block.stage.inputs, column, np.ones(at.size)))
        row, output = _pattern(block.scatter)
        through = summed((n_rows, block.count), (row, output // block.stage.outputs, np.ones(row.size)))
        readers.append(_pattern(through @ reach))
    row_of, column_of = (np.concatenate(parts) for parts in zip(*readers, strict=True))
    real = (np.isfinite(form.row_lower) | np.isfinite(form.row_upper))[row_of]
    row_of, column_of = row_of[real], column_of[real]
    low, high = with_stages(row_of, column_of, n_rows, low, high, constant)
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


def with_stages(
    rows: Indices, columns: Indices, count: int, low: Indices, high: Indices, constant: NDArray[np.bool_]
) -> tuple[Indices, Indices]:
    """Give columns without a stage that of the first row that couples them to columns of an interval.

    That row evaluates the state of an added row on the polynomial of the interval. The added path row depends on no
    other column. It would be put into the first stage, and the state would be carried through all stages in between.
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
    """Return the stage of every group: the last that all its columns have, else the first of the latest column."""
    free = ~constant[columns]
    group, columns = group[free], columns[free]
    latest, earliest = np.zeros(count, dtype=int), np.full(count, EVER)
    np.maximum.at(latest, group, low[columns])
    np.minimum.at(earliest, group, high[columns])
    earliest[earliest >= EVER] = latest[earliest >= EVER]
    return np.maximum(latest, earliest)
