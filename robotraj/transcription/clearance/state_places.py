"""Places of a phase at which distances are imposed: knots and collocation points, or given fractions of the phase."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.schemes.onestep import OneStep


@dataclass(frozen=True, eq=False)
class StatePlaces:
    """Places in the order of time.

    Attributes
    ----------
    columns : ndarray of int (m, nx)
        Columns of the state.
    fractions : ndarray (m,)
        Fractions of the phase.
    intervals : ndarray of int (m,)
        Interval of each place; a knot belongs to the interval on its right, the last to the last.
    taus : ndarray (m,)
        Fractions of the interval.
    first, last : ndarray of int (K,)
        Places at both ends of each interval.
    """

    columns: Indices
    fractions: Array
    intervals: Indices
    taus: Array
    first: Indices
    last: Indices


def state_places(layout: PhaseLayout) -> StatePlaces:
    """Return the places of a layout; in shooting, its knots."""
    columns: list[Indices] = []
    fractions, intervals, taus = [], [], []
    first: list[int] = []
    for run in layout.runs:
        shot = isinstance(run.scheme, OneStep)
        nodes = np.zeros(0) if shot else run.scheme.nodes
        inner = np.flatnonzero((nodes > 0.0) & (nodes < 1.0))
        for i, interval in enumerate(run.which.tolist()):
            first.append(len(columns))
            columns.append(layout.knots[interval])
            fractions.append(run.start[i])
            intervals.append(interval)
            taus.append(0.0)
            for j in inner.tolist():
                columns.append(run.states[i, j])
                fractions.append(run.start[i] + run.length[i] * nodes[j])
                intervals.append(interval)
                taus.append(float(nodes[j]))
    columns.append(layout.knots[-1])
    fractions.append(1.0)
    intervals.append(intervals[-1])
    taus.append(1.0)
    starts = np.array(first)
    return StatePlaces(
        np.array(columns),
        np.array(fractions),
        np.array(intervals),
        np.array(taus),
        starts,
        np.append(starts[1:], len(columns) - 1),
    )


@dataclass(frozen=True, eq=False)
class StateBetween:
    """The state at a fraction of a phase: weights (k,) of states of its interval, columns (k, nx)."""

    columns: Indices
    weights: Array


def states_between(layout: PhaseLayout, fractions: Array) -> list[StateBetween]:
    """Return the polynomials through the states of an interval at fractions (m,), linear ones in shooting."""
    starts = layout.fractions
    within = np.clip(np.searchsorted(starts, fractions, side="right") - 1, 0, len(starts) - 2)
    taus = (fractions - starts[within]) / np.diff(starts)[within]
    known: dict[int, tuple[Array, Indices]] = {}
    for run in layout.runs:
        shot = isinstance(run.scheme, OneStep)
        nodes = np.zeros(0) if shot else run.scheme.nodes
        inner = np.flatnonzero((nodes > 0.0) & (nodes < 1.0))
        sites = np.concatenate([[0.0], nodes[inner], [1.0]])
        for i, interval in enumerate(run.which.tolist()):
            states = [layout.knots[interval], *run.states[i, inner], layout.knots[interval + 1]]
            known[interval] = sites, np.array(states)
    found = []
    for interval, tau in zip(within.tolist(), taus.tolist(), strict=True):
        sites, columns = known[interval]
        others = [np.delete(sites, k) for k in range(len(sites))]
        weights = [np.prod((tau - other) / (site - other)) for site, other in zip(sites, others, strict=True)]
        found.append(StateBetween(columns, np.array(weights)))
    return found
