"""Rows of the invariants of a phase: at every node above 0 of its intervals, and at its start.

Linearly dependent rows disturb a solver. Redundant rows are therefore removed. They are those at a fixed end, and those
at a start that a link equates to an end with the same invariants.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Mask
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.variable import Variable
from robotraj.problem.constraints.base import symbols_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.rows import RowTable
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.layout import PhaseLayout, entries_of
from robotraj.transcription.scalar_table import ScalarTable


def impose_invariants(
    phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, scatter: Triplets, outputs: int
) -> None:
    """Write I(x_j) = 0 for every node above 0; I are the last of the ``outputs`` of the phase's stage."""
    entries = entries_of(index, phase.dae.invariants)
    places, fractions = [], []
    for interval in layout.intervals:
        inner = interval.scheme.nodes > 0.0
        places.append(interval.places[inner])
        fractions.append(interval.start + interval.length * interval.scheme.nodes[inner])
    at, when = np.concatenate(places), np.concatenate(fractions)
    first = outputs - len(entries)
    open_end = ~determined_invariants(phase)[1]
    for i, entry in enumerate(entries):
        here = slice(None) if open_end[i] else slice(-1)
        added = rows.add([entry], when[here], 0.0, 0.0)[:, 0]
        scatter.add(added, at[here] * outputs + first + i, 1.0)


def start_invariants(phases: Sequence[Phase], index: int, links: Sequence[BoundLink]) -> list[int]:
    """Return the invariants to impose at the first knot of a phase."""
    at_start, _ = determined_invariants(phases[index])
    return np.flatnonzero(~at_start & ~_carried(phases, index, links)).tolist()


def determined_invariants(phase: Phase) -> tuple[Mask, Mask]:
    """Return which invariants the fixed start and the fixed end of a phase determine, (ni,) and (ni,)."""
    if not phase.dae.invariants:
        none = np.zeros(0, dtype=bool)
        return none, none
    at_start = _determined(phase, phase.start_bounds)
    return at_start, _determined(phase, phase.end_bounds, anchored=at_start)


_DEPENDENCE: WeakKeyDictionary[RowTable, tuple[Mask, Mask]] = WeakKeyDictionary()


def _dependence(phase: Phase) -> tuple[Mask, Mask]:
    """Return which states and parameters each invariant depends on, (ni, nx) and (ni, np)."""
    # Phases that differ in their ends alone share a table.
    if phase.rows not in _DEPENDENCE:
        _DEPENDENCE[phase.rows] = _read(phase)
    return _DEPENDENCE[phase.rows]


def _read(phase: Phase) -> tuple[Mask, Mask]:
    point = symbols_of(phase.dae, phase.parameter_names)
    rows = phase.dae.invariant(point)
    x, p = (ca.vertcat(ca.SX(0, 1), *named.values()) for named in (point.x, point.p))
    # States that the objective added come last; no invariant depends on them.
    x = ca.vertcat(x, ca.SX.sym("added", len(phase.dae.states) - x.numel()))
    return tuple(np.array(ca.DM(ca.jacobian_sparsity(rows, s), 1.0).full(), dtype=bool) for s in (x, p))  # type: ignore[return-value]


def _determined(phase: Phase, bounds: Bounds, anchored: Mask | None = None) -> Mask:
    """Return the rows of fixed states alone, without free parameters that the other end does not determine.

    ``anchored`` are the rows whose parameters the other end determines.
    """
    states, parameters = _dependence(phase)
    free = bounds.lower < bounds.upper
    moving = (states & free).any(axis=1)
    # J(q) v = 0 is satisfied at rest, for any q.
    rates = np.array([row.quantity == "contact velocity" for row in phase.dae.invariants])
    speeds = np.array([s.quantity == "velocity" for s in phase.dae.states])
    resting = ~free & (bounds.lower == 0.0)
    moving &= ~rates | (states & speeds & ~resting).any(axis=1)
    known = phase.parameter_bounds
    unknown = (parameters & (known.lower < known.upper)).any(axis=1)
    determined = np.asarray(~unknown) if anchored is None else ~unknown | anchored
    return np.asarray(~moving & determined)


def _carried(phases: Sequence[Phase], index: int, links: Sequence[BoundLink]) -> Mask:
    """Return the rows that hold at the start because a link equates it to the end of a phase with these rows.

    A contact may hold less than that of the same name before, or more, as a sole after its heel: its row along or about
    an axis is carried if the contact before has a row for this axis.
    """
    here = phases[index].dae.invariants
    carried = np.zeros(len(here), dtype=bool)
    for carry in (carry for link in links for carry in link.carries if carry.target == index):
        there = {(row.quantity, row.label, _axis(row)) for row in phases[carry.source].dae.invariants}
        moved = _moved_contacts(phases[carry.source], phases[index]) if not carry.partners else set()
        for i, row in enumerate(here):
            partner = (row.quantity, carry.partners.get(row.label, row.label), _axis(row))
            carried[i] |= row.quantity in carry.quantities and partner in there and row.label not in moved
    # The start determines the place of a contact, whose rows have the names of its anchors.
    footholds = {anchor.name for contact in phases[index].bound_contacts for anchor in contact.anchors}
    return carried & ~np.array([row.name in footholds for row in here], dtype=bool)


def _axis(row: Variable) -> str:
    """Return the part of a row's name for its axis, such as ``"x"`` of ``"rate.foot.x"``."""
    return row.name.rpartition(".")[2]


def _moved_contacts(before: Phase, after: Phase) -> set[str]:
    """Return the contacts that hold another point of their frame than before, and leave the frame free to turn."""
    old = {contact.name: contact for contact in before.bound_contacts}
    return {
        contact.name
        for contact in after.bound_contacts
        if contact.name in old
        and contact.touching != old[contact.name].touching
        and not any(_holds_attitude(each) for each in (contact, old[contact.name]))
    }


def _holds_attitude(contact: BoundContact) -> bool:
    """Return whether a contact holds all rotations of its frame: three in space, one in a plane."""
    lengths = sum(row.unit == "m" for row in contact.holds)
    return len(contact.holds) - lengths == (3 if lengths == 3 else 1)
