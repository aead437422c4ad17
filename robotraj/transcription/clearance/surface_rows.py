"""Rows that keep links of the robot apart by points of their exact surfaces.

Where two links come near each other along a known motion, points of one surface stay above planes of the other one:
n' (p_1(q) - p_2(q)) >= margin. Point p_2 is the nearest one to p_1 on the other surface, and n the normal there. They
are fixed along the known motion, so the rows are as smooth as the robot's kinematics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

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
from robotraj.transcription.clearance.surface_points import SurfacePoints, points_between
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

ENDS = 0.1
"""Fraction of a phase in which the margin grows from its value at a fixed end."""
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


def with_surface_rows(nlp: Nlp, every: Sequence[NearSurfaces | None]) -> Nlp:
    """Append the rows of each phase to an NLP."""
    table, blocks = ScalarTable.after(nlp.rows), list[Block]()
    for phase, near in enumerate(every):
        if near is not None:
            places = states_between(nlp.layouts[phase], FRACTIONS)
            for each in near.pairs:
                blocks += _blocks(nlp, near, phase, places, each, table)
    return with_distances(nlp, blocks, table) if blocks else nlp


def _blocks(
    nlp: Nlp, near: NearSurfaces, phase: int, places: list[StateBetween], each: NearPair, table: ScalarTable
) -> list[Block]:
    """Return the blocks of a pair: one for the points of each of both surfaces."""
    numbers = table.numbers([Entry(phase, "clearance", near.body.label(each.pair), "m")])
    first, second = near.body.joint[near.body.pairs[each.pair]].tolist()
    functions = function_of_links(near.robot, first, second), function_of_links(near.robot, second, first)
    found = []
    for function, points in zip(functions, _known_points(near, each, functions[0].positions), strict=True):
        at, *coordinates = points
        if not len(at):
            continue
        constants = np.column_stack([*coordinates, np.zeros(len(at))])
        rank = table.add_above(np.repeat(numbers, len(at)), FRACTIONS[at], _lower(each, FRACTIONS[at]))
        found.append(_block(nlp, function, [places[k] for k in at.tolist()], constants, rank))
    return found


def _block(nlp: Nlp, function: DistanceFunction, places: list[StateBetween], constants: Array, rank: Indices) -> Block:
    gather, scatter, count = Triplets(), Triplets(), len(function.positions)
    columns = np.concatenate([place.columns for place in places])[:, function.positions]
    weights = np.concatenate([place.weights for place in places])
    at = np.repeat(np.arange(len(places)), [len(place.weights) for place in places])
    gather.spread(at[:, None] * count + np.arange(count), columns, weights[:, None])
    scatter.add(rank, np.arange(len(rank)), 1.0)
    return Block(
        function.stage,
        gather.matrix((len(places) * count, len(nlp.variables))),
        np.ascontiguousarray(constants.T),
        scatter.matrix((int(rank.max()) + 1, len(rank))),
        np.zeros(len(rank)),
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
