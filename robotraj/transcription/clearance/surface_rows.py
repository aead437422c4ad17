"""Rows that keep links of the robot apart by points of their exact surfaces.

Where two links come near each other along a known motion, points of one surface stay above planes of the other one:
n' (p_1(q) - p_2(q)) >= margin. Point p_2 is the nearest one to p_1 on the other surface, and n the normal there. They
are fixed along the known motion, so the rows are as smooth as the robot's kinematics.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.robot.collision.own_body import OwnBody
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import Placed, hull_points, surface_points
from robotraj.robot.robot import Robot
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.clearance.clearance_rows import with_distances
from robotraj.transcription.clearance.distance_functions import DistanceFunction, function_of_links
from robotraj.transcription.clearance.state_places import StateBetween, states_between
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Path = Callable[[Array], Array]
"""From fractions of a phase (m,) to configurations (m, nq)."""

NEAR = 0.03
"""Height above the other surface up to which a point has a row [m]."""
APART = 1e-3
"""Distance of convex hulls from which the plane between them is the row [m]."""
TOUCHING = 1e-5
"""Distance of shapes up to which their nearest points have no direction [m]."""
POINTS = 4
"""Largest number of points of one surface at one place."""
SPREAD = 0.02
"""Least distance between two of these points [m]."""
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
    motion : callable
        The motion along which the rows are fixed.
    margin : float
        Least height [m].
    ends : (float, float)
        Least heights at the start and at the end, where these are fixed and nearer [m].
    reach : float
        Distance of the convex hulls up to which places have rows [m].
    """

    pair: int
    motion: Path
    margin: float
    ends: tuple[float, float]
    reach: float
    known: dict[int, list[_SurfacePoints]] = field(default_factory=dict, repr=False)
    """Points of all places that were computed before, by the shape that carries the first ones."""

    @cached_property
    def configurations(self) -> Array:
        """The motion at the places of the rows, (60, nq)."""
        return self.motion(FRACTIONS)


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


class _SurfacePoints(NamedTuple):
    """Points of one surface near another one: both points in their joints' frames (n, 3), and normals (n, 3)."""

    first: Array
    second: Array
    normals: Array


NONE = _SurfacePoints(*np.zeros((3, 0, 3)))


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
    first, second = near.body.pairs[each.pair].tolist()
    numbers = table.numbers([Entry(phase, "clearance", near.body.label(each.pair), "m")])
    found = []
    for inner, outer in ((first, second), (second, first)):
        function = function_of_links(near.robot, int(near.body.joint[inner]), int(near.body.joint[outer]))
        chosen = _known_points(near, each, function, inner, outer)
        counts = [len(points.first) for points in chosen]
        if not any(counts):
            continue
        at = np.repeat(np.arange(len(places)), counts)
        constants = np.concatenate(
            [np.column_stack([p.first, p.second, p.normals, np.zeros(len(p.first))]) for p in chosen]
        )
        rank = table.add_above(np.repeat(numbers, len(at)), FRACTIONS[at], _lower(each, FRACTIONS[at]))
        found.append(_block(nlp, function, [places[k] for k in at.tolist()], constants, rank))
    return found


def _block(nlp: Nlp, function: DistanceFunction, places: list[StateBetween], constants: Array, rank: Indices) -> Block:
    gather, scatter, count = Triplets(), Triplets(), len(function.positions)
    for k, place in enumerate(places):
        for columns, weight in zip(place.columns, place.weights.tolist(), strict=True):
            gather.add(k * count + np.arange(count), columns[function.positions], weight)
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


def _known_points(
    near: NearSurfaces, each: NearPair, function: DistanceFunction, inner: int, outer: int
) -> list[_SurfacePoints]:
    """Return the points of each place; they are computed once."""
    if inner not in each.known:
        body = near.body
        q = np.tile(near.robot.neutral, (len(each.configurations), 1))
        q[:, function.positions] = each.configurations[:, function.positions]
        each.known[inner] = [
            _points(body, inner, outer, body.placed(inner, *joints), body.placed(outer, *joints), each.reach)
            for joints in zip(*placements(near.robot, q), strict=True)
        ]
    return each.known[inner]


def _points(body: OwnBody, inner: int, outer: int, moves: Placed, stays: Placed, reach: float) -> _SurfacePoints:
    """Return points of a surface and of another one that are near each other where the two shapes are."""
    # The nearest points are those of one side.
    nearest, is_first = hull_points(moves, stays), inner < outer
    if nearest[0] > APART:
        # One plane separates the hulls.
        return _between(body, inner, outer, moves, stays, nearest) if is_first and nearest[0] <= reach else NONE
    nearest = surface_points(moves, stays) if is_first else (0.0, *nearest[1:])
    first = _between(body, inner, outer, moves, stays, nearest) if nearest[0] > TOUCHING else NONE
    lowest = _lowest(body, inner, outer, moves, stays)
    return _SurfacePoints(*map(np.concatenate, zip(first, lowest, strict=True)))


def _between(
    body: OwnBody, inner: int, outer: int, moves: Placed, stays: Placed, nearest: tuple[float, Array, Array]
) -> _SurfacePoints:
    """Return the nearest points of two shapes that are apart."""
    apart, *points = nearest
    own, other = (
        _in_joint(body, shape, (point - each.position) @ each.rotation)[None]
        for shape, each, point in zip((inner, outer), (moves, stays), points, strict=True)
    )
    return _SurfacePoints(own, other, (points[0] - points[1])[None] / apart)


def _lowest(body: OwnBody, inner: int, outer: int, moves: Placed, stays: Placed) -> _SurfacePoints:
    """Return the lowest points of a surface above another one, at least ``SPREAD`` apart."""
    own = moves.solid.spots
    there = moves.seen_from(stays, own)
    lower, upper = stays.solid.box
    close = np.flatnonzero(np.all((there > lower - NEAR) & (there < upper + NEAR), axis=1))
    if not close.size or not len(stays.solid.spots):
        return NONE
    heights = stays.solid.heights(there[close], NEAR)
    close, heights = close[heights < NEAR], heights[heights < NEAR]
    chosen: list[int] = []
    while close.size and len(chosen) < POINTS:
        chosen.append(int(close[np.argmin(heights)]))
        apart = np.linalg.norm(own[close] - own[chosen[-1]], axis=1) > SPREAD
        close, heights = close[apart], heights[apart]
    if not chosen:
        return NONE
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
