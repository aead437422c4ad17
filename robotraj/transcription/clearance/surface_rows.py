"""Rows that keep links of the robot apart by points of their exact surfaces.

Where two links come near each other along a known motion, points of one surface stay above planes of the other one:
n' (p_1(q) - p_2(q)) >= margin. Point p_2 is the nearest one to p_1 on the other surface, and n the normal there. They
are fixed along the known motion, so the rows are as smooth as the robot's kinematics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.robot.collision.own_body import OwnBody
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import Placed, hull_distance
from robotraj.robot.robot import Robot
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.clearance.clearance_rows import with_distances
from robotraj.transcription.clearance.distance_functions import DistanceFunction, function_of_links
from robotraj.transcription.clearance.state_places import StatePlaces, state_places
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Path = Callable[[Array], Array]
"""From fractions of a phase (m,) to configurations (m, nq)."""

NEAR = 0.03
"""Height above the other surface up to which a point has a row [m]."""
POINTS = 4
"""Largest number of points of one surface at one place."""
SPREAD = 0.02
"""Least distance between two of these points [m]."""
ENDS = 0.1
"""Fraction of a phase in which the margin grows from its value at a fixed end."""


@dataclass(frozen=True, eq=False)
class NearSurfaces:
    """Pairs of shapes that came near each other in a phase, and the motion along which their rows are fixed.

    Attributes
    ----------
    robot : Robot
    body : OwnBody
    motion : callable
        The known motion.
    margins : mapping of int to float
        Least height of each pair [m].
    ends : mapping of int to (float, float)
        Least heights at the start and at the end, where these are fixed and nearer [m].
    """

    robot: Robot
    body: OwnBody
    motion: Path
    margins: Mapping[int, float]
    ends: Mapping[int, tuple[float, float]]


class _SurfacePoints(NamedTuple):
    """Points of one surface near another one: both points in their joints' frames (n, 3), and normals (n, 3)."""

    first: Array
    second: Array
    normals: Array


def with_surface_rows(nlp: Nlp, every: Sequence[NearSurfaces | None]) -> Nlp:
    """Append the rows of each phase to an NLP; rows on fixed states are omitted."""
    table, blocks = ScalarTable.after(nlp.rows), list[Block]()
    for phase, near in enumerate(every):
        if near is not None:
            layout = nlp.layouts[phase]
            places = state_places(layout)
            for pair in near.margins:
                blocks += _blocks(nlp, near, phase, layout, places, pair, table)
    return with_distances(nlp, blocks, table) if blocks else nlp


def _blocks(
    nlp: Nlp,
    near: NearSurfaces,
    phase: int,
    layout: PhaseLayout,
    places: StatePlaces,
    pair: int,
    table: ScalarTable,
) -> list[Block]:
    """Return the blocks of a pair: one for the points of each of both surfaces."""
    first, second = near.body.pairs[pair].tolist()
    numbers = table.numbers([Entry(phase, "clearance", near.body.label(pair), "m")])
    found = []
    for inner, outer in ((first, second), (second, first)):
        function = function_of_links(near.robot, int(near.body.joint[inner]), int(near.body.joint[outer]))
        free = _free_places(nlp, places, function)
        rows = [(place, _points(near, function, inner, outer, place, places)) for place in free.tolist()]
        rows = [(place, points) for place, points in rows if len(points.first)]
        if not rows:
            continue
        at = np.repeat([place for place, _ in rows], [len(points.first) for _, points in rows])
        constants = np.concatenate(
            [np.column_stack([p.first, p.second, p.normals, np.zeros(len(p.first))]) for _, p in rows]
        )
        fractions = places.fractions[at]
        rank = table.add_above(np.repeat(numbers, len(at)), fractions, _lower(near, pair, fractions))
        found.append(_block(nlp, function, places.columns[at][:, function.positions], constants, rank))
    return found


def _free_places(nlp: Nlp, places: StatePlaces, function: DistanceFunction) -> Indices:
    """Return the places at which some position of the function is free."""
    columns = places.columns[:, function.positions]
    return np.flatnonzero(np.any(nlp.variables.lower[columns] < nlp.variables.upper[columns], axis=1))


def _block(nlp: Nlp, function: DistanceFunction, columns: Indices, constants: Array, rank: Indices) -> Block:
    gather, scatter = Triplets(), Triplets()
    gather.add(np.arange(columns.size), columns.ravel(), 1.0)
    scatter.add(rank, np.arange(len(rank)), 1.0)
    return Block(
        function.stage,
        gather.matrix((columns.size, len(nlp.variables))),
        np.ascontiguousarray(constants.T),
        scatter.matrix((int(rank.max()) + 1, len(rank))),
        np.zeros(len(rank)),
    )


def _lower(near: NearSurfaces, pair: int, fractions: Array) -> Array:
    """Return the least heights (n,) [m]: the margin, or less near an end that is nearer."""
    margin, (start, end) = near.margins[pair], near.ends[pair]
    away = np.clip(np.column_stack([fractions, 1.0 - fractions]) / ENDS, 0.0, 1.0)
    grown = np.minimum([start, end], margin)
    return np.asarray((grown + (margin - grown) * away).min(axis=1))


def _points(
    near: NearSurfaces, function: DistanceFunction, inner: int, outer: int, place: int, places: StatePlaces
) -> _SurfacePoints:
    """Return the lowest points of a surface above another one, at least ``SPREAD`` apart, at a place."""
    body = near.body
    q = near.robot.neutral.copy()
    q[function.positions] = near.motion(places.fractions[place : place + 1])[0, function.positions]
    rotations, origins = (each[0] for each in placements(near.robot, q[None]))
    moves, stays = (body.placed(shape, rotations, origins) for shape in (inner, outer))
    if hull_distance(moves, stays) > NEAR:
        return _SurfacePoints(*np.zeros((3, 0, 3)))
    own = moves.solid.spots
    there = moves.seen_from(stays, own)
    lower, upper = stays.solid.box
    close = np.flatnonzero(np.all((there > lower - NEAR) & (there < upper + NEAR), axis=1))
    if not close.size or not len(stays.solid.spots):
        return _SurfacePoints(*np.zeros((3, 0, 3)))
    heights = stays.solid.heights(there[close], NEAR)
    close, heights = close[heights < NEAR], heights[heights < NEAR]
    chosen: list[int] = []
    while close.size and len(chosen) < POINTS:
        chosen.append(int(close[np.argmin(heights)]))
        apart = np.linalg.norm(own[close] - own[chosen[-1]], axis=1) > SPREAD
        close, heights = close[apart], heights[apart]
    if not chosen:
        return _SurfacePoints(*np.zeros((3, 0, 3)))
    kept, feet, normals = _feet(stays, there[chosen])
    return _SurfacePoints(
        _in_joint(body, inner, own[chosen][kept]), _in_joint(body, outer, feet), normals @ stays.rotation.T
    )


def _feet(stays: Placed, points: Array) -> tuple[Indices, Array, Array]:
    """Return which points are near a surface, the nearest points on it and its normals there, all in its axes."""
    inside = stays.solid.contains(points)
    feet = np.array([stays.solid.nearest(point) for point in points])
    apart = points - feet
    length = np.linalg.norm(apart, axis=1)
    normals = np.where(inside, -1.0, 1.0)[:, None] * apart / np.maximum(length, 1e-12)[:, None]
    # A point on the surface has no direction to it.
    kept = np.flatnonzero((inside | (length < NEAR)) & (length > 1e-6))
    return kept, feet[kept], normals[kept]


def _in_joint(body: OwnBody, shape: int, points: Array) -> Array:
    return np.asarray(points @ body.rotation[shape].T + body.position[shape])
