"""Two orders of elimination of an NLP that is a chain of intervals: against time, and by nested dissection in time.

A minimum-degree order does not see the chain, and its last fronts may grow with the mesh.

- Against time: the unknowns of an interval and of the knot behind it are eliminated before those of the interval
  before. A front then reaches to the next knot alone, as in a Riccati recursion.
- By dissection: the chain is cut in the middle, and each half again. What lies on both sides of a cut is eliminated
  after the halves. This takes fewer products where both ends of the motion are linked.

Source: George, Nested dissection of a regular finite element mesh, SIAM J. Numerical Analysis 10, 1973.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Indices
from robotraj.solvers.stagewise.order import EVER, allowed_stages, with_stages
from robotraj.transcription.nlp import Nlp


def elimination_groups(nlp: Nlp, free: Indices, rows: Indices, columns: Indices, count: int) -> NDArray[np.int32]:
    """Assign groups to columns and rows by each order; they are eliminated from the smallest number on.

    Parameters
    ----------
    nlp : Nlp
    free : ndarray of int (n_y,)
        Columns of the NLP that are unknowns.
    rows, columns : ndarray of int (m,)
        Entries of the Jacobian over the unknowns.
    count : int
        Number of rows.

    Returns
    -------
    ndarray of int (2, n_y + count)
        Of columns, then of rows; against time, then by dissection.
    """
    ends = [min(link.phases) for link in nlp.problem.bound_links]
    low, high, stages = allowed_stages(nlp.layouts, nlp.link_columns, ends, len(nlp.variables))
    low, high = with_stages(rows, columns, count, low[free], high[free], np.zeros(free.size, dtype=bool))
    first, last = _of_rows(rows, columns, count, low, high)
    begin, end = np.append(low, first), np.append(high, last)
    return np.array([stages - np.minimum(begin, stages), _dissected(begin, end, stages)], dtype=np.int32)


def _of_rows(rows: Indices, columns: Indices, count: int, low: Indices, high: Indices) -> tuple[Indices, Indices]:
    """First and last stage of each row: those of its columns of single stages, else the ones that all columns have."""
    single = (low == high)[columns]
    first, last = np.full(count, EVER), np.full(count, -1)
    np.minimum.at(first, rows[single], low[columns[single]])
    np.maximum.at(last, rows[single], high[columns[single]])
    latest, earliest = np.zeros(count, dtype=np.int64), np.full(count, EVER)
    np.maximum.at(latest, rows, low[columns])
    np.minimum.at(earliest, rows, high[columns])
    none = first > last
    return np.where(none, latest, first), np.where(none, np.maximum(latest, earliest), last)


def _dissected(first: Indices, last: Indices, stages: int) -> Indices:
    """Assign groups by a dissection of the stages: both halves before what reaches across the cut."""
    number = np.zeros(first.size, dtype=np.int64)
    groups = 0
    # Ranges of stages with their members; the second visit to a range numbers its separator.
    pending = [(0, stages, np.arange(first.size), False)]
    while pending:
        begin, end, members, cut = pending.pop()
        middle = (begin + end) // 2
        if cut or end - begin <= 1:
            number[members] = groups
            groups += 1
            continue
        before, after = last[members] < middle, first[members] >= middle
        pending.append((begin, end, members[~before & ~after], True))
        pending.append((middle, end, members[after], False))
        pending.append((begin, middle, members[before], False))
    return number
