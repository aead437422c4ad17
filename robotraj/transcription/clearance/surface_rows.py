"""Rows that keep links of the robot apart by points of their exact surfaces.

Where two links come near each other along a known motion, points of one surface stay above planes of the other one:
n' (p_1(q) - p_2(q)) >= margin. Point p_2 is the nearest one to p_1 on the other surface, and n the normal there. They
are fixed along the known motion, so the rows are as smooth as the robot's kinematics.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import field
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.robot.collision.own_body import OwnBody
from robotraj.robot.robot import Robot
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.clearance.clearance_rows import with_distances
from robotraj.transcription.clearance.distance_functions import DistanceFunction, function_of_links
from robotraj.transcription.clearance.state_places import StateBetween, states_between
from robotraj.transcription.clearance.surface_points import POINTS, SurfacePoints, points_between
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

ENDS = 0.1
"""Fraction of a phase in which the margin grows from its value at a fixed end."""
TOGETHER = POINTS + 1
"""Number of rows that one evaluation of a function has: as many as the points of one surface at one place."""
FRACTIONS: Array = np.linspace(0.5 / 60, 1.0 - 0.5 / 60, 60)
"""Fractions of a phase at which rows are imposed on every mesh; between them, motions are compared with the shapes."""


@dataclass(frozen=True, eq=False)
class NearPair:
    """Rows of a pair of shapes.

    Attributes
    ----------
    pair : int
        In ``OwnBody.pairs``.
    configurations : ndarray (60, nq)
        The motion along which the rows are fixed, at ``FRACTIONS``.
    margin : float
        Least height [m].
    ends : (float, float)
        Least heights at the start and at the end, where these are fixed and nearer [m].
    reach : float
        Distance of the convex hulls up to which places have rows [m].
    """

    pair: int
    configurations: Array
    margin: float
    ends: tuple[float, float]
    reach: float
    known: list[tuple[SurfacePoints, SurfacePoints]] = field(default_factory=list, repr=False)
    """Points of both surfaces at all places, once they are computed."""


@dataclass(frozen=True, eq=False)
class NearSurfaces:
    """Pairs of shapes that rows keep apart in a phase.

    Attributes
    ----------
    robot : Robot
    body : OwnBody
    pairs : tuple of NearPair
        A pair may have rows along several motions.
    """

    robot: Robot
    body: OwnBody
    pairs: tuple[NearPair, ...]


class _PlaneRows(NamedTuple):
    """Rows of points of two surfaces: their places in ``FRACTIONS``, constants and numbers in the program."""

    at: Indices
    constants: Array
    rank: Indices


def with_surface_rows(nlp: Nlp, every: Sequence[NearSurfaces | None]) -> Nlp:
    """Append the rows of each phase to an NLP; those of all pairs of shapes on the same two joints are one block."""
    table, blocks = ScalarTable.after(nlp.rows), list[Block]()
    for phase, near in enumerate(every):
        if near is not None:
            found = defaultdict[DistanceFunction, list[_PlaneRows]](list)
            for each in near.pairs:
                joint, other = near.body.joint[near.body.pairs[each.pair]].tolist()
                function = function_of_links(near.robot, joint, other, TOGETHER)
                entry = Entry(phase, "clearance", near.body.label(each.pair), "m")
                found[function] += _rows(near, each, function.positions, entry, table)
            places = states_between(nlp.layouts[phase], FRACTIONS)
            blocks += [_block(nlp, function, places, rows) for function, rows in found.items() if rows]
    return with_distances(nlp, blocks, table) if blocks else nlp


def _rows(near: NearSurfaces, each: NearPair, positions: Indices, entry: Entry, table: ScalarTable) -> list[_PlaneRows]:
    """Add the rows of a pair to a table: those of the points of each of both surfaces."""
    numbers, found = table.numbers([entry]), []
    for points, is_swapped in zip(_known_points(near, each, positions), (False, True), strict=True):
        at, first, second, normals = points
        if len(at):
            both = (second, first, -normals) if is_swapped else (first, second, normals)
            rank = table.add_above(np.repeat(numbers, len(at)), FRACTIONS[at], _lower(each, FRACTIONS[at]))
            found.append(_PlaneRows(at, np.column_stack([*both, np.zeros(len(at))]), rank))
    return found


def _block(nlp: Nlp, function: DistanceFunction, every: list[StateBetween], rows: list[_PlaneRows]) -> Block:
    """Return the block of the rows on two joints, whose function is evaluated once for ``TOGETHER`` of a place."""
    at, constants, rank = (np.concatenate(each) for each in zip(*rows, strict=True))
    order = np.argsort(at, kind="stable")
    at, constants, rank = at[order], constants[order], rank[order]
    # The number of each row at its place.
    number = np.arange(len(at)) - np.searchsorted(at, at)
    starts = number % TOGETHER == 0
    group, slot = np.cumsum(starts) - 1, number % TOGETHER
    places = [every[k] for k in at[starts].tolist()]
    together = np.zeros((len(places), TOGETHER, constants.shape[1]))
    together[group, slot] = constants
    gather, scatter, count = Triplets(), Triplets(), len(function.positions)
    columns = np.concatenate([place.columns for place in places])[:, function.positions]
    weights = np.concatenate([place.weights for place in places])
    which = np.repeat(np.arange(len(places)), [len(place.weights) for place in places])
    gather.spread(which[:, None] * count + np.arange(count), columns, weights[:, None])
    scatter.add(rank, group * TOGETHER + slot, 1.0)
    return Block(
        function.stage,
        gather.matrix((len(places) * count, len(nlp.variables))),
        np.ascontiguousarray(together.reshape(len(places), -1).T),
        scatter.matrix((int(rank.max()) + 1, len(places) * TOGETHER)),
        np.zeros(len(places)),
    )


def _lower(each: NearPair, fractions: Array) -> Array:
    """Return the least heights (n,) [m]: the margin, or less near an end that is nearer."""
    away = np.clip(np.column_stack([fractions, 1.0 - fractions]) / ENDS, 0.0, 1.0)
    grown = np.minimum(each.ends, each.margin)
    return np.asarray((grown + (each.margin - grown) * away).min(axis=1))


def _known_points(near: NearSurfaces, each: NearPair, positions: Indices) -> tuple[SurfacePoints, SurfacePoints]:
    """Return the points of both surfaces at all places; they are computed once."""
    if not each.known:
        first, second = near.body.pairs[each.pair].tolist()
        # The joints that move neither of the two against the other are neutral, as they are in the rows.
        q = np.tile(near.robot.neutral, (len(each.configurations), 1))
        q[:, positions] = each.configurations[:, positions]
        each.known.append(points_between(near.robot, near.body, first, second, q, each.reach))
    return each.known[0]
