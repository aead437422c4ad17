"""Rows on distances: the pairs that are near on intervals of a known motion, and the NLP with their rows.

A pair that comes near on an interval has rows at all places of the interval. Their lower bound is the margin plus a
small slack, plus the shortfall of the proof on the interval.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.problem.clearance.end_checks import clearances_of
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.clearance.distance_functions import (
    DistanceFunction,
    constants_of,
    function_of,
    key_of,
)
from robotraj.transcription.clearance.state_places import StatePlaces, state_places
from robotraj.transcription.clearance.supporting_planes import Motion, heights, in_axes, in_world, planes
from robotraj.transcription.collocation.ends import widen
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

SAMPLES = 5
"""Number of places of an interval at which a known motion is evaluated."""
FURTHER = 0.02
"""Largest distance by which a sphere with rows may be further than the nearest sphere of its link [m]."""
SIDE = 2e-3
"""Distance beyond the margin that a known motion must keep from the plane of another place [m]."""
NEAR = 0.05
"""Distance beyond the margin below which a pair has rows [m]."""
SLACK = 5e-4
"""Distance beyond the margin that rows impose, so that a proof between the points succeeds [m]."""


@dataclass(frozen=True, eq=False)
class Clearances:
    """The pairs of one ``CollisionFree`` of a phase.

    Attributes
    ----------
    phase, number : int
        Indices of the phase, and of the constraint among those of the phase.
    pairs : ClearancePairs
    slack : ndarray (n,)
        Distance beyond the margin that rows of each pair impose [m]; less where an end of the phase has less.
    """

    phase: int
    number: int
    pairs: ClearancePairs
    slack: Array


def clearances(nlp: Nlp) -> list[Clearances]:
    """Return the pairs that the phases of an NLP keep apart."""
    found = []
    for index, (phase, layout) in enumerate(zip(nlp.problem.phases, nlp.layouts, strict=True)):
        for number, pairs in enumerate(clearances_of(phase.constraints, phase.robot)):
            slack = np.full(len(pairs), SLACK)
            for knot, time in ((0, layout.t0), (-1, None)) if phase.path is None else ():
                columns = layout.knots[knot][: pairs.robot.nq]
                lower, upper = nlp.variables.lower[columns], nlp.variables.upper[columns]
                if np.array_equal(lower, upper) and (time is None or time.column is None):
                    t = layout.t0.value + (layout.duration.value if knot else 0.0)
                    left = pairs.distances(lower[None], np.array([t]))[0] - pairs.margin
                    slack = np.minimum(slack, 0.5 * np.maximum(left, 0.0))
            found.append(Clearances(index, number, pairs, slack))
    return found


class Nearest(NamedTuple):
    """Where each pair is nearest on each interval along a motion: fractions of the phase and distances [m], (K, n)."""

    fractions: Array
    distances: Array


def nearest_along(own: Clearances, layout: PhaseLayout, motion: Motion) -> Nearest:
    """Return the least distance of each pair on each interval along a motion."""
    knots = layout.fractions
    at = knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.0, 1.0, SAMPLES)
    distances = own.pairs.distances(*motion(at.ravel())).reshape(*at.shape, -1)
    where = distances.argmin(axis=1)
    least = np.take_along_axis(distances, where[:, None], axis=1)[:, 0]
    return Nearest(np.take_along_axis(at, where, axis=1), least)


def near_pairs(own: Clearances, nearest: Nearest) -> Indices:
    """Return (interval, pair) of pairs that come near along a motion, (k, 2).

    Of the spheres of a link near one obstacle or link, only those within ``FURTHER`` of the nearest are returned.
    """
    found, pairs, spheres = nearest.distances, own.pairs, own.pairs.spheres
    against = np.arange(len(pairs)) < pairs.against
    other = np.where(against, pairs.second, len(pairs.obstacles) + spheres.link[np.where(against, 0, pairs.second)])
    _, group = np.unique(np.column_stack([spheres.link[pairs.first], other]), axis=0, return_inverse=True)
    numbers = group.ravel()
    least = np.full((int(numbers.max(initial=-1)) + 1, len(found)), np.inf)
    np.minimum.at(least, numbers, found.T)
    return np.argwhere((found < pairs.margin + NEAR) & (found < least[numbers].T + FURTHER))


class Raised(NamedTuple):
    """Raise of the bound of a pair on an interval beyond its slack [m], and the round in which its rows were added.

    Rows of earlier rounds come first, so that they keep their numbers from round to round.
    """

    amount: float
    since: int


RaisedPairs = Mapping[tuple[int, int], Raised]
"""Raises by (interval, pair), for all pairs with rows."""


def with_clearance_rows(
    nlp: Nlp,
    every: Sequence[Clearances],
    kept: Sequence[RaisedPairs],
    motions: Sequence[Motion],
    nearest: Sequence[Nearest],
) -> Nlp:
    """Append rows on distances to an NLP without any; rows on fixed states are omitted.

    Parameters
    ----------
    nlp : Nlp
    every : sequence of Clearances
    kept : sequence of mapping
        The pairs that have rows, for each of ``every``.
    motions : sequence of callable
        The motion along which normals are fixed, for each of ``every``.
    nearest : sequence of Nearest
        Where the pairs are nearest along it.
    """
    table = ScalarTable.after(nlp.rows)
    blocks: list[Block] = []
    for own, raised, motion, least in zip(every, kept, motions, nearest, strict=True):
        if not raised:
            continue
        layout = nlp.layouts[own.phase]
        places = state_places(layout)
        groups: dict[object, list[_Row]] = {}
        for (interval, pair), (amount, since) in raised.items():
            for place in range(int(places.first[interval]), int(places.last[interval]) + 1):
                row = _Row(place, pair, float(least.fractions[interval, pair]), amount)
                groups.setdefault((since, key_of(own.pairs, pair)), []).append(row)
        for group in groups.values():
            blocks += _block(nlp, own, layout, places, group, motion, table)
    if not blocks:
        return nlp
    return with_distances(nlp, blocks, table)


def with_distances(nlp: Nlp, blocks: Sequence[Block], table: ScalarTable) -> Nlp:
    """Return an NLP with further blocks whose outputs are rows on distances [m].

    Parameters
    ----------
    nlp : Nlp
    blocks : sequence of Block
        Blocks whose scatters write to the new rows, after those of ``nlp``.
    table : ScalarTable
        Table of the new rows.
    """
    rows = nlp.rows.joined(table.finish())
    shape = (len(rows), len(nlp.variables))
    for block in blocks:
        block.stage.as_tapes = nlp.engine.separate_torques
    linear = nlp.linear.copy()
    linear.resize(shape)
    return replace(
        nlp,
        rows=rows,
        blocks=tuple(widen(block, *shape) for block in (*nlp.blocks, *blocks)),
        linear=linear,
        row_scale=np.append(nlp.row_scale, np.ones(len(rows) - len(nlp.rows))),
        loose_rows=None if nlp.loose_rows is None else nlp.loose_rows.joined(table.finish()),
        keeps_clear=True,
    )


class _Row(NamedTuple):
    """A row: its place, its pair, the fraction of the phase where the pair is nearest, and its raise [m]."""

    place: int
    pair: int
    nearest: float
    raised: float


def _block(
    nlp: Nlp,
    own: Clearances,
    layout: PhaseLayout,
    places: StatePlaces,
    group: Sequence[_Row],
    motion: Motion,
    table: ScalarTable,
) -> list[Block]:
    """Return the block of rows with one point function in a list, which is empty if all their states are fixed."""
    clock = layout.clock(0)
    free = (clock.base.column is not None, clock.span.column is not None)
    function = function_of(own.pairs, group[0].pair, free)
    every = places.columns[[row.place for row in group]][:, function.positions]
    chosen = np.any(nlp.variables.lower[every] < nlp.variables.upper[every], axis=1)
    columns, rows = every[chosen], [row for row, is_free in zip(group, chosen.tolist(), strict=True) if is_free]
    if not rows:
        return []
    pairs = np.array([row.pair for row in rows])
    at_places, nearest = places.fractions[[row.place for row in rows]], np.array([row.nearest for row in rows])
    given = _planes(own, function, pairs, nearest, at_places, motion)
    constants = np.column_stack([constants_of(own.pairs, pairs), given])
    if function.timed:
        columns, constants = _with_clock(layout, places, rows, columns, constants)
    distinct, which = np.unique(pairs, return_inverse=True)
    entries = [Entry(own.phase, "clearance", own.pairs.label(pair), "m") for pair in distinct.tolist()]
    lower = own.pairs.margin + own.slack[pairs] + np.array([row.raised for row in rows])
    numbers = table.add_above(table.numbers(entries)[which.ravel()], at_places, lower)
    gather, scatter = Triplets(), Triplets()
    gather.add(np.arange(columns.size), columns.ravel(), 1.0)
    scatter.add(numbers, np.arange(len(rows)), 1.0)
    return [
        Block(
            function.stage,
            gather.matrix((columns.size, len(nlp.variables))),
            np.ascontiguousarray(constants.T),
            scatter.matrix((int(numbers.max()) + 1, len(rows))),
            np.zeros(len(rows)),
        )
    ]


def _planes(
    own: Clearances, function: DistanceFunction, pairs: Indices, nearest: Array, at: Array, motion: Motion
) -> Array:
    """Return the planes (n, 4) of rows.

    All rows of a pair on an interval have the plane of its nearest place. Shapes on both sides of one plane at the ends
    hardly cross it in between. A row that the known motion would violate has the plane of its own place. Planes of a
    moving obstacle are in its axes.
    """
    neutral = own.pairs.robot.neutral
    obstacle = own.pairs.obstacles[int(own.pairs.second[pairs[0]])] if function.timed else None

    def moved(fractions: Array) -> tuple[Array, Array]:
        known, times = motion(fractions)
        q = np.tile(neutral, (len(fractions), 1))
        q[:, function.positions] = known[:, function.positions]
        return q, times

    here, times = moved(at)
    there, before = moved(nearest)
    found = planes(own.pairs, pairs, there, before)
    if obstacle is not None:
        found = in_axes(obstacle, before, found)
    placed = found if obstacle is None else in_world(obstacle, times, found)
    wrong = np.flatnonzero(heights(own.pairs, pairs, here, placed) < own.pairs.margin + SIDE)
    if wrong.size:
        own_planes = planes(own.pairs, pairs[wrong], here[wrong], times[wrong])
        found[wrong] = own_planes if obstacle is None else in_axes(obstacle, times[wrong], own_planes)
    return found


def _with_clock(
    layout: PhaseLayout, places: StatePlaces, rows: Sequence[_Row], columns: Indices, constants: Array
) -> tuple[Indices, Array]:
    """Append the columns of free clocks, and prepend tau and the fixed scalars of clocks to the constants."""
    more, before = [], []
    for row in rows:
        interval = int(places.intervals[row.place])
        clock = layout.clock(interval)
        scalars = (clock.base, clock.span)
        more.append([scalar.column for scalar in scalars if scalar.column is not None])
        tau = clock.start + clock.length * float(places.taus[row.place])
        before.append([tau, *(scalar.value for scalar in scalars if scalar.column is None)])
    both = np.column_stack([columns, np.array(more, dtype=int).reshape(len(rows), -1)])
    return both, np.column_stack([np.array(before), constants])
