"""Rounds of rows on distances: added where pairs come near, raised where a proof between the points is short."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation
from robotraj.transcription.clearance.clearance_rows import (
    Clearances,
    clearances,
    near_rows,
    rows_on_intervals,
    with_clearance_rows,
    with_distances,
    with_own_distances,
)
from robotraj.transcription.clearance.places import state_places
from robotraj.transcription.clearance.proof import Shortfalls, shortfalls
from robotraj.transcription.nlp import ClearanceRow, Nlp

ROUNDS = 10
"""Solves with further or raised rows on one mesh."""
MORE = 1.2
"""Distances are raised this many times what was short: the motion moves along, and with it what is short."""
LEAST = 2e-5
"""Least amount by which a distance is raised [m]."""
MOST = 0.02
"""Largest amount by which a distance is raised in one round [m]."""


class Clearing:
    """The distances that one NLP keeps, from solve to solve.

    Parameters
    ----------
    nlp : Nlp
        Before its first solve.
    """

    def __init__(self, nlp: Nlp) -> None:
        self._every = clearances(nlp)
        self._found: list[tuple[Clearances, Shortfalls]] = []

    def __bool__(self) -> bool:
        """Whether a phase has a ``CollisionFree``."""
        return bool(self._every)

    def begin(self, nlp: Nlp) -> Nlp:
        """Add rows on the pairs that are near at the guess."""
        if not self._every:
            return nlp
        nlp = with_own_distances(nlp, self._every)
        return with_clearance_rows(nlp, self._every, near_rows(nlp, nlp.guess, self._every))

    def measure(self, solution: Solution) -> None:
        """Prove the distances along a solution."""
        self._found = [(own, shortfalls(own.pairs, solution.phases[own.phase].trajectory.x)) for own in self._every]

    @property
    def proved(self) -> bool:
        """Whether all distances of the solution that was measured are proved."""
        return all(not found.pairs.size for _, found in self._found)

    def tightened(self, nlp: Nlp, w: NDArray[np.float64]) -> Nlp:
        """Add rows on what was short, and raise the rows that are there already."""
        rows: list[ClearanceRow] = []
        raised: dict[ClearanceRow, float] = {}
        for own, found in self._found:
            places = state_places(nlp.layouts[own.phase])
            each = zip(found.intervals.tolist(), found.pairs.tolist(), found.distances.tolist(), strict=True)
            for interval, pair, distance in each:
                wanted = rows_on_intervals(own, places, np.array([[interval, pair]]))
                known = [row for row in wanted if row in nlp.clearance_rows]
                short = own.pairs.margin - distance
                amount = min(max(MORE * short, LEAST), MOST)
                # Ends are fixed and have no rows.
                if len(known) == len(wanted) or (known and short < LEAST):
                    raised |= {row: max(amount, raised.get(row, 0.0)) for row in known}
                rows += [row for row in wanted if row not in nlp.clearance_rows]
        more = with_clearance_rows(nlp, self._every, [*rows, *near_rows(nlp, w, self._every)])
        unchanged = more is nlp and not raised
        if unchanged:
            for own, found in self._found:
                places = state_places(nlp.layouts[own.phase])
                every = np.column_stack([found.intervals, found.pairs])
                raised |= {row: LEAST for row in rows_on_intervals(own, places, every) if row in nlp.clearance_rows}
        return with_distances(more, raised) if raised else more

    def violations(self, solution: Solution) -> Iterator[Violation]:
        """Yield the pairs whose distance is not proved, each with its worst time."""
        for own, found in self._found:
            worst: dict[int, int] = {}
            for k, pair in enumerate(found.pairs.tolist()):
                if pair not in worst or found.distances[k] < found.distances[worst[pair]]:
                    worst[pair] = k
            for pair, k in worst.items():
                name, margin = solution.phases[own.phase].phase.name, own.pairs.margin
                short = margin - float(found.distances[k])
                label, time = own.pairs.label(pair), float(found.times[k])
                yield Violation(name, "clearance", label, time, short, "m", margin, "under", 1.0)
