"""Rows on distances: which pairs are near at which places, and the NLP that has them.

Rows are only added. A pair that comes near at one place of an interval has rows at all places of the interval. Their
lower bound is the margin with a small slack, and with what a proof was short of on the interval.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.problem.clearance.ends import clearances_of
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.clearance.distance_functions import constants_of, function_of, key_of
from robotraj.transcription.clearance.places import StatePlaces, state_places
from robotraj.transcription.collocation.ends import widen
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import ClearanceRow, Nlp
from robotraj.transcription.table import Entry, ScalarTable

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

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
            for knot, time in ((0, layout.t0), (-1, None)):
                columns = layout.knots[knot][: pairs.robot.nq]
                lower, upper = nlp.variables.lower[columns], nlp.variables.upper[columns]
                if np.array_equal(lower, upper) and (time is None or time.column is None):
                    t = layout.t0.value + (layout.duration.value if knot else 0.0)
                    left = pairs.distances(lower[None], np.array([t]))[0] - pairs.margin
                    slack = np.minimum(slack, 0.5 * np.maximum(left, 0.0))
            found.append(Clearances(index, number, pairs, slack))
    return found


def near_rows(nlp: Nlp, w: Array, every: Sequence[Clearances]) -> list[ClearanceRow]:
    """Return rows of pairs that are near at a decision vector, at all places of the intervals."""
    found = []
    for own in every:
        layout = nlp.layouts[own.phase]
        places = state_places(layout)
        q = w[places.columns[:, : own.pairs.robot.nq]]
        times = np.interp(places.fractions, layout.fractions, layout.breaks(w))
        near = own.pairs.distances(q, times) < own.pairs.margin + NEAR
        found += rows_on_intervals(own, places, _intervals_of(places, near))
    return found


def rows_on_intervals(own: Clearances, places: StatePlaces, chosen: Indices) -> list[ClearanceRow]:
    """Return rows of (interval, pair) at every place of the interval."""
    rows: dict[tuple[int, int], None] = {}
    for interval, pair in chosen.tolist():
        for place in range(int(places.first[interval]), int(places.last[interval]) + 1):
            rows[place, pair] = None
    return [ClearanceRow(own.phase, own.number, place, pair) for place, pair in rows]


def _intervals_of(places: StatePlaces, near: NDArray[np.bool_]) -> Indices:
    """Return (interval, pair) of pairs that are near at a place of the interval."""
    at = np.array([near[first : last + 1].any(axis=0) for first, last in zip(places.first, places.last, strict=True)])
    return np.argwhere(at)


def with_clearance_rows(nlp: Nlp, every: Sequence[Clearances], rows: Sequence[ClearanceRow]) -> Nlp:
    """Add rows to an NLP, which come last; rows on states that are fixed, or that it has already, are left out."""
    known, kept = nlp.clearance_rows, dict(nlp.clearance_rows)
    table = ScalarTable.after(nlp.rows)
    blocks: list[Block] = []
    for own in every:
        layout = nlp.layouts[own.phase]
        places = state_places(layout)
        groups: dict[object, list[ClearanceRow]] = {}
        for row in rows:
            if (row.phase, row.constraint) == (own.phase, own.number) and row not in known:
                groups.setdefault(key_of(own.pairs, row.pair), []).append(row)
        for group in groups.values():
            made, numbers = _block(nlp, own, layout, places, group, table)
            blocks += made
            kept |= numbers
    if not blocks:
        return nlp
    constraints = nlp.rows.joined(table.finish())
    shape = (len(constraints), len(nlp.variables))
    for block in blocks:
        block.stage.as_tapes = nlp.engine.separate_torques
    linear = nlp.linear.copy()
    linear.resize(shape)
    return replace(
        nlp,
        rows=constraints,
        blocks=tuple(widen(block, *shape) for block in (*nlp.blocks, *blocks)),
        linear=linear,
        row_scale=np.append(nlp.row_scale, np.ones(len(constraints) - len(nlp.rows))),
        loose_rows=None if nlp.loose_rows is None else nlp.loose_rows.joined(table.finish()),
        clearance_rows=kept,
    )


def _block(
    nlp: Nlp,
    own: Clearances,
    layout: PhaseLayout,
    places: StatePlaces,
    group: Sequence[ClearanceRow],
    table: ScalarTable,
) -> tuple[list[Block], dict[ClearanceRow, int]]:
    """Return the block of rows with one function, none where all their states are fixed, and their numbers."""
    clock = layout.clock(0)
    free = (clock.base.column is not None, clock.span.column is not None)
    function = function_of(own.pairs, group[0].pair, free)
    every = places.columns[[row.place for row in group]][:, function.positions]
    chosen = np.any(nlp.variables.lower[every] < nlp.variables.upper[every], axis=1)
    columns, rows = every[chosen], [row for row, is_free in zip(group, chosen.tolist(), strict=True) if is_free]
    if not rows:
        return [], {}
    constants = constants_of(own.pairs, np.array([row.pair for row in rows]))
    if function.timed:
        columns, constants = _with_clock(layout, places, rows, columns, constants)
    entries = {row.pair: Entry(own.phase, "clearance", own.pairs.label(row.pair), "m") for row in rows}
    numbers = np.empty(len(rows), dtype=int)
    for i, row in enumerate(rows):
        at = places.fractions[row.place : row.place + 1]
        numbers[i] = table.add([entries[row.pair]], at, own.pairs.margin + own.slack[row.pair])[0, 0]
    gather, scatter = Triplets(), Triplets()
    gather.add(np.arange(columns.size), columns.ravel(), 1.0)
    scatter.add(numbers, np.arange(len(rows)), 1.0)
    block = Block(
        function.stage,
        gather.matrix((columns.size, len(nlp.variables))),
        np.ascontiguousarray(constants.T),
        scatter.matrix((int(numbers.max()) + 1, len(rows))),
        np.zeros(len(rows)),
    )
    return [block], dict(zip(rows, numbers.tolist(), strict=True))


def _with_clock(
    layout: PhaseLayout, places: StatePlaces, rows: Sequence[ClearanceRow], columns: Indices, constants: Array
) -> tuple[Indices, Array]:
    """Add the columns of free clocks, and before the constants the place on the clock and the fixed ones."""
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


def with_own_distances(nlp: Nlp, every: Sequence[Clearances]) -> Nlp:
    """Set the lower bounds of the rows that an earlier program had to the margins and slacks of this problem."""
    if not nlp.clearance_rows:
        return nlp
    lower, known = nlp.rows.lower.copy(), {(own.phase, own.number): own for own in every}
    for row, number in nlp.clearance_rows.items():
        own = known[row.phase, row.constraint]
        lower[number] = own.pairs.margin + own.slack[row.pair]
    return _with_lower(nlp, lower)


def with_distances(nlp: Nlp, beyond: Mapping[ClearanceRow, float]) -> Nlp:
    """Raise the lower bounds of rows on distances [m]; functions and blocks are shared."""
    lower = nlp.rows.lower.copy()
    for row, amount in beyond.items():
        lower[nlp.clearance_rows[row]] += amount
    return _with_lower(nlp, lower)


def _with_lower(nlp: Nlp, lower: Array) -> Nlp:
    again = replace(nlp, rows=replace(nlp.rows, lower=lower))
    if "functions" in nlp.__dict__:
        again.__dict__["functions"] = replace(nlp.functions, preparing=0.0)
    return again
