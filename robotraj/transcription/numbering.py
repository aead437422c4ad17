"""Numbering of the unknowns of a phase: a column of the decision vector for each.

States have columns at knots and at the inner nodes of each interval, algebraic variables at nodes, controls at their
sites. Where the schemes on both sides of a knot have a node or a control site there, the neighbours share the value.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate, groupby

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.problem.phase import Phase
from robotraj.transcription.layout import PhaseLayout, Run, Scalar, entries_of
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.collocation import Scheme
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep


def lay_out(phase: Phase, index: int, mesh: Mesh, table: ScalarTable) -> PhaseLayout:
    """Add the columns of a phase to the table, ordered by time, and return their layout."""
    dae = phase.dae
    t0 = _scalar(table, Entry(index, "start time", "", "s"), *((0.0, 0.0) if index == 0 else (0.0, np.inf)))
    duration = _scalar(table, Entry(index, "duration", "", "s"), *phase.duration_bounds)
    parameters = tuple(
        _scalar(table, Entry(index, "parameter", name, ""), low, high)
        for name, low, high in zip(phase.parameter_names, *phase.parameter_bounds, strict=True)
    )
    schemes, breaks = mesh.schemes, mesh.knots
    whole = schemes[0].over(breaks) if isinstance(schemes[0], OneStep) else None
    lengths = mesh.lengths
    if whole is not None:
        schemes, breaks, lengths = (whole,), np.array([0.0, 1.0]), np.ones(1)
    _check_invariants(phase, schemes)
    knots = [table.add(entries_of(index, dae.states), breaks[:1])]
    x, z, u = (table.numbers(entries_of(index, group)) for group in (dae.states, dae.algebraic, dae.controls))
    invariants = table.numbers([Entry(index, "correction", v.label, v.unit) for v in dae.invariants])
    own_clocks = _clocks(breaks, index, table) if isinstance(mesh, MovingMesh) else None
    clock_lengths = lengths if own_clocks is None else np.ones(len(lengths))
    runs: list[Run] = []
    owners: list[Indices] = []
    places_before = 0
    for which, scheme, join in _joins(schemes, own_clocks is not None, bool(len(u))):
        nodes, sites = scheme.nodes, scheme.control_sites
        inner = np.flatnonzero((nodes > 0.0) & (nodes < 1.0))
        # New columns of an interval of the run, with their places in the interval: controls, algebraic variables, inner
        # states, the state at its right knot, corrections.
        parts = [
            (u, sites[join.control :]),
            (z, nodes[join.place :]),
            (x, nodes[inner]),
            (x, np.ones(1)),
            (invariants, nodes[nodes > 0.0]),
        ]
        at = np.concatenate([where.repeat(len(group)) for group, where in parts])
        fractions = breaks[which, None] + lengths[which, None] * at
        sizes = [len(group) * len(where) for group, where in parts]
        ends = list(accumulate(sizes))
        fractions[:, ends[2] : ends[3]] = breaks[which + 1, None]
        added = table.add_each(np.concatenate([np.tile(group, len(where)) for group, where in parts]), fractions)
        controls, algebraic, inside, right, corrections = (
            added[:, end - size : end].reshape(len(which), len(where), len(group))
            for size, end, (group, where) in zip(sizes, ends, parts, strict=True)
        )
        before = runs[-1] if runs else None
        if join.control and before is not None:
            controls = _chain(before.controls[-1, -1], controls)
        if join.place and before is not None:
            algebraic = _chain(before.algebraic[-1, -1], algebraic)
        left = np.concatenate([knots[-1][-1:], right[:-1, 0]])
        states = np.empty((len(which), len(nodes), len(x)), dtype=int)
        states[:, inner] = inside
        states[:, nodes == 0.0], states[:, nodes == 1.0] = left[:, None], right
        fresh = len(nodes) - join.place
        places = places_before + np.arange(len(which) * fresh).reshape(len(which), fresh)
        places_before += places.size
        owner = np.empty((*places.shape, 2), dtype=int)
        owner[..., 0], owner[..., 1] = which[:, None], np.arange(join.place, len(nodes))
        owners.append(owner.reshape(-1, 2))
        if join.place and before is not None:
            places = _chain(before.places[-1, -1:], places[:, :, None])[:, :, 0]
        knots.append(right[:, 0])
        columns = (states, left, right[:, 0], algebraic, controls, places, corrections)
        run = Run(scheme, which, breaks[which], lengths[which], clock_lengths[which], *columns)
        if before is not None and before.scheme == scheme:
            runs[-1] = before.joined(run)
        else:
            runs.append(run)
    owned = np.concatenate(owners)
    return PhaseLayout(mesh, np.concatenate(knots), tuple(runs), t0, duration, parameters, owned, own_clocks)


def _joins(schemes: Sequence[Scheme], moving: bool, controlled: bool) -> Iterator[tuple[Indices, Scheme, _Join]]:
    """Yield neighbouring intervals of one scheme, the scheme, and their shared values with the left neighbour."""
    first, before = 0, None
    for scheme, group in groupby(schemes):
        last = first + len(list(group))
        alone = _Join(0, 0)
        join = alone if moving or before is None else _Join.of(scheme, before, controlled)
        further = alone if moving else _Join.of(scheme, scheme, controlled)
        if join == further:
            yield np.arange(first, last), scheme, join
        else:
            yield np.arange(first, first + 1), scheme, join
            if last > first + 1:
                yield np.arange(first + 1, last), scheme, further
        first, before = last, scheme


@dataclass(frozen=True)
class _Join:
    """Values shared with the interval on the left: 1 where the first control, or the first place, is shared."""

    control: int
    place: int

    @classmethod
    def of(cls, here: Scheme, before: Scheme, controlled: bool) -> _Join:
        control = here.control_sites[0] == 0.0 and before.control_sites[-1] == 1.0
        # A control that jumps at a knot causes two accelerations there, so that the knot is evaluated on both sides.
        place = here.nodes[0] == 0.0 and before.nodes[-1] == 1.0 and (control or not controlled)
        return cls(int(control), int(place))


def _check_invariants(phase: Phase, schemes: Sequence[Scheme]) -> None:
    """Refuse schemes without a collocation point at the end of an interval, where invariants must hold."""
    if not phase.dae.invariants:
        return
    for scheme in schemes:
        if isinstance(scheme, OneStep) or scheme.nodes[-1] != 1.0:
            names = ", ".join(dict.fromkeys(v.label for v in phase.dae.invariants))
            raise InputError(
                f"Phase {phase.name!r} holds {names} at its knots, but {type(scheme).__name__} has no collocation "
                "point there; use a Lobatto or Radau scheme such as rt.HermiteSimpson() or rt.schemes.RadauIIA(3)."
            )


def _clocks(breaks: Array, index: int, table: ScalarTable) -> Indices:
    """Add the start and the length of every interval as unknowns."""
    starts = table.add([Entry(index, "start of interval", "", "s")], breaks[:-1])
    spans = table.add([Entry(index, "length of interval", "", "s")], breaks[:-1], 0.0, np.inf)
    return np.hstack([starts, spans])


def _scalar(table: ScalarTable, entry: Entry, low: float, high: float) -> Scalar:
    """Add a column; fixed quantities are constants of the point functions instead."""
    if low == high:
        return Scalar(None, low)
    return Scalar(int(table.add([entry], np.zeros(1), low, high)[0, 0]))


def _chain(first: Indices, fresh: Indices) -> Indices:
    """Prepend to the columns (n, m, .) of each interval the last ones of the interval before it, or ``first``."""
    return np.concatenate([np.concatenate([first[None], fresh[:-1, -1]])[:, None], fresh], axis=1)
