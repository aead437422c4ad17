"""Rows on distances in a fixed number, whose planes follow the motion from solve to solve.

Every knot of a phase has rows for each joint that carries shapes, and for each two joints whose shapes may touch. A
row is the plane between the two shapes that are nearest there along the last motion (``nearest_planes.py``). Planes
are constants, so that a control loop changes them before each solve without building the program again.

Moving obstacles have their poses at the times of the knots. A measured start that is too near is no conflict: the
shortfall is allowed to decrease to zero within ``RECOVERY``.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.problem.clearance.end_checks import clearances_of
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.clearance.clearance_rows import SLACK, with_distances
from robotraj.transcription.clearance.distance_functions import DistanceFunction, function_of, key_of
from robotraj.transcription.clearance.nearest_planes import NearestPlanes
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

NEAREST = 2
"""Number of pairs of a joint's shapes, with obstacles or shapes of another joint, that have rows at a knot."""
RECOVERY = 0.2
"""Time within which a start that is too near must reach the margin [s]."""


@dataclass(frozen=True, eq=False)
class _PlaneGroup:
    """Rows with one function.

    Attributes
    ----------
    function : DistanceFunction
    pairs : ndarray of int
        Pairs of which the nearest have rows.
    count : int
        Number of rows at a knot.
    """

    function: DistanceFunction
    pairs: Indices
    count: int


class PlaneRows:
    """The rows on distances of an NLP of one phase.

    Parameters
    ----------
    nlp : Nlp
        NLP of one phase, without rows on distances.

    Raises
    ------
    InputError
        The phase has several ``CollisionFree``.
    """

    def __init__(self, nlp: Nlp) -> None:
        phase = nlp.problem.phases[0]
        found = clearances_of(phase.constraints, phase.robot)
        if len(found) != 1:
            raise InputError(f"Phase {phase.name!r} has {len(found)} rt.CollisionFree; join them to one.")
        self._pairs: ClearancePairs = found[0]
        layout = nlp.layouts[0]
        self._fractions = layout.fractions
        columns = np.array(layout.knots)[:, : self._pairs.robot.nq]
        # Rows on fixed states are omitted.
        self._free = np.flatnonzero(np.any(nlp.variables.lower[columns] < nlp.variables.upper[columns], axis=1))
        self._columns = columns
        self._rows = _grouped(self._pairs)
        self._nearest = self._found_in(self._pairs)

    def _found_in(self, pairs: ClearancePairs) -> NearestPlanes:
        return NearestPlanes(pairs, [own.pairs for own in self._rows], [own.count for own in self._rows])

    def added(self, nlp: Nlp) -> Nlp:
        """Add the rows to the NLP, with planes along its guess."""
        pairs, table, blocks = self._pairs, ScalarTable.after(nlp.rows), []
        lower, fractions = pairs.margin + SLACK, self._fractions[self._free]
        for own, constants in zip(self._rows, self._constants(nlp, nlp.guess), strict=True):
            at = np.repeat(self._free, own.count)
            columns = self._columns[at][:, own.function.positions]
            entry = table.numbers([Entry(0, "clearance", _label(pairs, own), "m")])
            numbers = table.add_above(
                np.repeat(entry, len(at)), np.repeat(fractions, own.count), np.full(len(at), lower)
            )
            gather, scatter = Triplets(), Triplets()
            gather.add(np.arange(columns.size), columns.ravel(), 1.0)
            scatter.add(numbers, np.arange(len(at)), 1.0)
            blocks.append(
                Block(
                    own.function.stage,
                    gather.matrix((columns.size, len(nlp.variables))),
                    constants,
                    scatter.matrix((int(numbers.max()) + 1, len(at))),
                    np.zeros(len(at)),
                )
            )
        return with_distances(nlp, blocks, table)

    def place_obstacles(self, obstacles: Sequence[Obstacle]) -> None:
        """Replace the obstacles by as many others in the same order.

        Raises
        ------
        InputError
            The number of obstacles differs, or one is no obstacle or on a frame of the robot.
        """
        count = len(self._pairs.obstacles)
        is_world = all(isinstance(each, Obstacle) and each.frame is None for each in obstacles)
        if len(obstacles) != count or not is_world:
            raise InputError(
                f"obstacles= must be {count} obstacles in the world, as in the problem; got {obstacles!r}."
            )
        self._pairs = self._pairs.with_obstacles(obstacles)
        self._nearest = self._found_in(self._pairs)

    def constants(self, nlp: Nlp, w: Array) -> dict[PointFunctions, Array]:
        """Return the constants of every point function, with planes along w (n_w,) at the times of the NLP."""
        found = self._constants(nlp, w)
        return {own.function.stage: each for own, each in zip(self._rows, found, strict=True)}

    def _constants(self, nlp: Nlp, w: Array) -> list[Array]:
        pairs, free, centre = self._pairs, self._free, self._pairs.spheres.centre
        q = w[self._columns]
        elapsed = self._fractions * _duration(nlp.layouts[0], w)
        # The first knot is the measured state, which differs from that of w.
        q[0] = nlp.variables.lower[self._columns[0]]
        found = self._nearest.along(q, nlp.layouts[0].t0.value + elapsed)
        short = np.maximum(pairs.margin + SLACK - found.first_distances, 0.0)
        share = np.maximum(1.0 - elapsed[free] / RECOVERY, 0.0)
        constants: list[Array] = []
        for own, nearest, planes in zip(self._rows, found.pairs, found.planes, strict=True):
            chosen, given = nearest[free], planes[free]
            given[..., 3] -= short[chosen] * share[:, None]
            centres = [centre[pairs.first[chosen]]]
            if own.pairs[0] >= pairs.against:
                centres.append(centre[pairs.second[chosen]])
            joined = np.concatenate([*centres, given], axis=2)
            constants.append(np.ascontiguousarray(joined.reshape(len(free) * own.count, -1).T))
        return constants


def _grouped(pairs: ClearancePairs) -> list[_PlaneGroup]:
    """Return the pairs with one function, those with obstacles first."""
    groups: dict[Hashable, list[int]] = {}
    for pair in range(len(pairs)):
        groups.setdefault(key_of(pairs, pair, plane=True), []).append(pair)
    rows = []
    for own in groups.values():
        function = function_of(pairs, own[0], plane=True)
        if function.positions.size:
            rows.append(_PlaneGroup(function, np.array(own), min(NEAREST, len(own))))
    return rows


def _label(pairs: ClearancePairs, own: _PlaneGroup) -> str:
    first = int(own.pairs[0])
    if first < pairs.against:
        return f"{pairs.names(first)[0]} and the nearest obstacles"
    return pairs.label(first)


def _duration(layout: PhaseLayout, w: Array) -> float:
    scalar = layout.duration
    return float(scalar.value if scalar.column is None else w[scalar.column])
