"""Rows that hold the invariants of a phase: at every collocation point above a knot, and at its start.

A row that could not be otherwise is left out, for a solver stumbles over rows that say the same twice: at an end that
is fixed, and at a start that a link makes equal to the end of a phase which holds the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.problem.constraints.base import symbols_of
from robotraj.problem.links.base import BoundLink
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.layout import PhaseLayout, entries_of
from robotraj.transcription.table import ScalarTable

if TYPE_CHECKING:
    from robotraj.problem.constraints.bounds import Bounds
    from robotraj.problem.phase import Phase

Mask = NDArray[np.bool_]


def hold(phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, scatter: Triplets, outputs: int) -> None:
    """Write I(x_j) = 0 for every node above 0; I stands last in the ``outputs`` of the phase's stage."""
    entries = entries_of(index, phase.dae.invariants)
    places, fractions = [], []
    for interval in layout.intervals:
        inner = interval.scheme.nodes > 0.0
        places.append(interval.places[inner])
        fractions.append(interval.start + interval.length * interval.scheme.nodes[inner])
    at, when = np.concatenate(places), np.concatenate(fractions)
    first = outputs - len(entries)
    open_end = ~_settled(phase, phase.end_bounds, anchored=_settled(phase, phase.start_bounds))
    for i, entry in enumerate(entries):
        here = slice(None) if open_end[i] else slice(-1)
        added = rows.add([entry], when[here], 0.0, 0.0)[:, 0]
        scatter.add(added, at[here] * outputs + first + i, 1.0)


def start_rows(phases: Sequence[Phase], index: int, links: Sequence[BoundLink]) -> list[int]:
    """Invariants to impose at the first knot of a phase."""
    return np.flatnonzero(
        ~_settled(phases[index], phases[index].start_bounds) & ~_carried(phases, index, links)
    ).tolist()


_DEPENDENCE: WeakKeyDictionary[Phase, tuple[Mask, Mask]] = WeakKeyDictionary()


def _dependence(phase: Phase) -> tuple[Mask, Mask]:
    """Which invariants read which states and which parameters, (ni, nx) and (ni, np)."""
    if phase not in _DEPENDENCE:
        _DEPENDENCE[phase] = _read(phase)
    return _DEPENDENCE[phase]


def _read(phase: Phase) -> tuple[Mask, Mask]:
    point = symbols_of(phase.dae, phase.parameter_names)
    rows = phase.dae.invariant(point)
    x, p = (ca.vertcat(ca.SX(0, 1), *named.values()) for named in (point.x, point.p))
    # States that the objective added come last, and no invariant reads them.
    x = ca.vertcat(x, ca.SX.sym("added", len(phase.dae.states) - x.numel()))
    return tuple(np.array(ca.DM(ca.jacobian_sparsity(rows, s), 1.0).full(), dtype=bool) for s in (x, p))  # type: ignore[return-value]


def _settled(phase: Phase, bounds: Bounds, anchored: Mask | None = None) -> Mask:
    """Rows that read fixed states alone, and no free parameter unless the other end settled it (``anchored``)."""
    states, parameters = _dependence(phase)
    free = bounds.lower < bounds.upper
    moving = (states & free).any(axis=1)
    # J(q) v says nothing where v is zero, whatever q is.
    rates = np.array([row.quantity == "contact velocity" for row in phase.dae.invariants])
    speeds = np.array([s.quantity == "velocity" for s in phase.dae.states])
    resting = ~free & (bounds.lower == 0.0)
    moving &= ~rates | (states & speeds & ~resting).any(axis=1)
    known = phase.parameter_bounds
    unknown = (parameters & (known.lower < known.upper)).any(axis=1)
    settled = np.asarray(~unknown) if anchored is None else ~unknown | anchored
    return np.asarray(~moving & settled)


def _carried(phases: Sequence[Phase], index: int, links: Sequence[BoundLink]) -> Mask:
    """Rows that hold at the start because a link carries them over from the end of a phase that holds them."""
    here = phases[index].dae.invariants
    carried = np.zeros(len(here), dtype=bool)
    for carry in (carry for link in links for carry in link.carries if carry.target == index):
        there = {(row.quantity, row.label) for row in phases[carry.source].dae.invariants}
        for i, row in enumerate(here):
            partner = carry.partners.get(row.label, row.label)
            carried[i] |= row.quantity in carry.quantities and (row.quantity, partner) in there
    # Where a contact stands is found out at the start: the rows that say where bear the names of its anchors.
    footholds = {anchor.name for contact in phases[index].bound_contacts for anchor in contact.anchors}
    return carried & ~np.array([row.name in footholds for row in here], dtype=bool)
