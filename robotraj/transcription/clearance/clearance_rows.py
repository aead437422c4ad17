"""Rows on distances: the NLP with rows on the pairs that are near on intervals of a known motion.

A pair that comes near on an interval has rows at all places of the interval. Their lower bound is the margin plus a
small slack, plus the shortfall of the proof on the interval.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, MutableMapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
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
from robotraj.transcription.clearance.near_pairs import Nearest, near_pairs, nearest_along
from robotraj.transcription.clearance.state_places import StatePlaces, state_places
from robotraj.transcription.clearance.supporting_planes import Motion, heights, in_axes, in_world, planes
from robotraj.transcription.collocation.ends import widen
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, ScalarTable

SIDE = 2e-3
"""Distance beyond the margin that a known motion must keep from the plane of another place [m]."""
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


RaisedPairs = Mapping[tuple[int, int], float]
"""Raise of the bound beyond its slack [m] by (interval, pair), for all pairs with rows, the earlier ones first."""


def with_rows_along(
    nlp: Nlp,
    every: Sequence[Clearances],
    motions: Sequence[Motion],
    kept: Sequence[MutableMapping[tuple[int, int], float]],
    near: float,
) -> Nlp:
    """Append rows on the pairs that come near along known motions, and on those that have rows already.

    Parameters
    ----------
    nlp : Nlp
        Without any such rows.
    every : sequence of Clearances
    motions : sequence of callable
        The motion along which normals are fixed, for each of ``every``.
    kept : sequence of mutable mapping
        Pairs with rows; those that come near are added.
    near : float
        Distance from the margin below which a pair is near [m].
    """
    found = [
        nearest_along(own.pairs, nlp.layouts[own.phase], motion) for own, motion in zip(every, motions, strict=True)
    ]
    for own, nearest, raised in zip(every, found, kept, strict=True):
        for interval, pair in near_pairs(own.pairs, nearest, near).tolist():
            raised.setdefault((interval, pair), 0.0)
    return with_clearance_rows(nlp, every, kept, motions, found)


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
        if raised:
            blocks += _blocks(nlp, own, raised, motion, least, table)
    return with_distances(nlp, blocks, table) if blocks else nlp


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


class _PlaceRows(NamedTuple):
    """Rows as arrays (n,): their places, pairs, bounds, and the fractions of the phase where the pairs are nearest."""

    places: Indices
    pairs: Indices
    lower: Array
    nearest: Array

    def chosen(self, which: Indices) -> _PlaceRows:
        """Return some of the rows."""
        return _PlaceRows(self.places[which], self.pairs[which], self.lower[which], self.nearest[which])


def _place_rows(own: Clearances, raised: RaisedPairs, nearest: Nearest, places: StatePlaces) -> _PlaceRows:
    """Return the rows of pairs at all places of their intervals, in the order of ``raised``."""
    intervals, pairs = np.array(list(raised)).T
    first = places.first[intervals]
    counts = places.last[intervals] - first + 1
    which = np.repeat(np.arange(len(pairs)), counts)
    before = np.cumsum(counts) - counts
    at = first[which] + np.arange(len(which)) - before[which]
    lower = own.pairs.margin + own.slack[pairs] + np.array(list(raised.values()))
    return _PlaceRows(at, pairs[which], lower[which], nearest.fractions[intervals, pairs][which])


def _blocks(
    nlp: Nlp, own: Clearances, raised: RaisedPairs, motion: Motion, nearest: Nearest, table: ScalarTable
) -> list[Block]:
    """Return one block for each point function, and add its rows to the table in the order of ``raised``."""
    layout = nlp.layouts[own.phase]
    clock, places = layout.clock(0), state_places(layout)
    free = (clock.base.column is not None, clock.span.column is not None)
    rows = _place_rows(own, raised, nearest, places)
    distinct, which = np.unique(rows.pairs, return_inverse=True)
    alike: dict[Hashable, list[int]] = {}
    for number, pair in enumerate(distinct.tolist()):
        alike.setdefault(key_of(own.pairs, pair), []).append(number)
    parts: list[tuple[DistanceFunction, Indices, Indices]] = []
    for numbers in alike.values():
        function = function_of(own.pairs, int(distinct[numbers[0]]), free)
        group = np.flatnonzero(np.isin(which, numbers))
        columns = places.columns[rows.places[group]][:, function.positions]
        is_free = np.any(nlp.variables.lower[columns] < nlp.variables.upper[columns], axis=1)
        if is_free.any():
            parts.append((function, group[is_free], columns[is_free]))
    if not parts:
        return []
    kept = np.sort(np.concatenate([group for _, group, _ in parts]))
    entries = [Entry(own.phase, "clearance", own.pairs.label(pair), "m") for pair in distinct.tolist()]
    meaning, at = table.numbers(entries)[which.ravel()], places.fractions[rows.places]
    rank = np.zeros(len(which), dtype=int)
    rank[kept] = table.add_above(meaning[kept], at[kept], rows.lower[kept])
    return [
        _block(nlp, own, layout, places, rows.chosen(group), function, columns, rank[group], motion)
        for function, group, columns in parts
    ]


def _block(
    nlp: Nlp,
    own: Clearances,
    layout: PhaseLayout,
    places: StatePlaces,
    rows: _PlaceRows,
    function: DistanceFunction,
    columns: Indices,
    numbers: Indices,
    motion: Motion,
) -> Block:
    """Return the block of rows with one point function."""
    given = _planes(own, function, rows.pairs, rows.nearest, places.fractions[rows.places], motion)
    constants = np.column_stack([constants_of(own.pairs, rows.pairs), given])
    if function.timed:
        columns, constants = _with_clock(layout, places, rows.places, columns, constants)
    gather, scatter = Triplets(), Triplets()
    gather.add(np.arange(columns.size), columns.ravel(), 1.0)
    scatter.add(numbers, np.arange(len(numbers)), 1.0)
    return Block(
        function.stage,
        gather.matrix((columns.size, len(nlp.variables))),
        np.ascontiguousarray(constants.T),
        scatter.matrix((int(numbers.max()) + 1, len(numbers))),
        np.zeros(len(numbers)),
    )


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
    layout: PhaseLayout, places: StatePlaces, at: Indices, columns: Indices, constants: Array
) -> tuple[Indices, Array]:
    """Append the columns of free clocks, and prepend tau and the fixed scalars of clocks to the constants."""
    more, before = [], []
    for place in at.tolist():
        clock = layout.clock(int(places.intervals[place]))
        scalars = (clock.base, clock.span)
        more.append([scalar.column for scalar in scalars if scalar.column is not None])
        tau = clock.start + clock.length * float(places.taus[place])
        before.append([tau, *(scalar.value for scalar in scalars if scalar.column is None)])
    both = np.column_stack([columns, np.array(more, dtype=int).reshape(len(at), -1)])
    return both, np.column_stack([np.array(before), constants])
