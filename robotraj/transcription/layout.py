"""Where the unknowns of a phase stand in the decision vector.

States stand at knots and at the inner nodes of each interval, algebraic variables at nodes, controls at the control's
sites. Where the schemes on both sides of a knot have a node (or a control site) there, the neighbours share the value.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, groupby
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robotraj.errors import InputError
from robotraj.schemes import Mesh, MovingMesh, OneStep
from robotraj.transcription.table import Entry, ScalarTable

if TYPE_CHECKING:
    from robotraj.dynamics import Variable
    from robotraj.problem import Phase

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True)
class Scalar:
    """A quantity that is a column of the NLP, or a constant where its bounds fix it."""

    column: int | None
    value: float = 0.0

    def of(self, w: Array) -> float:
        """Value for a decision vector w in physical units."""
        return self.value if self.column is None else float(w[self.column])


@dataclass(frozen=True)
class Clock:
    """How an interval reads time: t = base + (start + length c) span, for c in [0, 1].

    On a fixed mesh base and span are those of the phase, on a moving mesh they are the interval's own unknowns.
    """

    base: Scalar
    span: Scalar
    start: float
    length: float

    def ends(self, w: Array) -> tuple[float, float]:
        """First and last time of the interval for a decision vector w [s]."""
        first = self.base.of(w) + self.start * self.span.of(w)
        return first, first + self.length * self.span.of(w)


@dataclass(frozen=True, eq=False)
class IntervalLayout:
    """Columns of one interval.

    Attributes
    ----------
    scheme : Scheme
    start, length : float
        As fractions of the phase; on a moving mesh, before it moves.
    clock : Clock
    states : Indices (s + ..., nx)
        Columns of the state at each node.
    left, right : Indices (nx,)
        Columns of the state at both knots.
    algebraic : Indices (s, nz)
        Columns of z at each node.
    controls : Indices (m, nu)
        Columns of u at each control site.
    places : Indices (s,)
        The evaluation of the stage function that serves each node.
    corrections : Indices (r, ni)
        Columns of the corrections that hold the invariants, at the r nodes above 0; each is read at its node's place.
    """

    scheme: Any
    start: float
    length: float
    clock: Clock
    states: Indices
    left: Indices
    right: Indices
    algebraic: Indices
    controls: Indices
    places: Indices
    corrections: Indices


@dataclass(frozen=True, eq=False)
class Run:
    """Neighbouring intervals of one scheme, with their columns as arrays (n, ...) like those of ``IntervalLayout``."""

    scheme: Any
    which: Indices
    start: Array
    length: Array
    clock_length: Array
    states: Indices
    left: Indices
    right: Indices
    algebraic: Indices
    controls: Indices
    places: Indices
    corrections: Indices

    @property
    def columns(self) -> tuple[Indices, ...]:
        """Everything that ``IntervalLayout`` has a row of, in its order."""
        return self.states, self.left, self.right, self.algebraic, self.controls, self.places, self.corrections

    def joined(self, other: Run) -> Run:
        """Put the run of the same scheme that follows behind this one."""
        pairs = zip(self._arrays, other._arrays, strict=True)
        return Run(self.scheme, *(np.concatenate(pair) for pair in pairs))

    @property
    def _arrays(self) -> tuple[Any, ...]:
        return self.which, self.start, self.length, self.clock_length, *self.columns


@dataclass(frozen=True, eq=False)
class PhaseLayout:
    """Columns of one phase.

    Attributes
    ----------
    knots : Indices (K + 1, nx)
        In single shooting, whose phase is one interval, those of both ends.
    runs : tuple of Run
        The intervals, those of one scheme that follow each other together.
    t0, duration : Scalar
    parameters : tuple of Scalar
    place_owner : Indices (places, 2)
        For every evaluation of the stage function, an interval and a node that use it.
    own_clocks : Indices (K, 2) or None
        Columns of the start and the length of every interval, on a moving mesh.
    """

    mesh: Mesh
    knots: Indices
    runs: tuple[Run, ...]
    t0: Scalar
    duration: Scalar
    parameters: tuple[Scalar, ...]
    place_owner: Indices
    own_clocks: Indices | None

    @property
    def scheme(self) -> Any:
        """The scheme of the first interval."""
        return self.runs[0].scheme

    @property
    def count(self) -> int:
        """Number of intervals K."""
        return len(self.knots) - 1

    @cached_property
    def intervals(self) -> tuple[IntervalLayout, ...]:
        """The intervals, one by one."""
        return tuple(
            IntervalLayout(
                run.scheme,
                run.start[i],
                run.length[i],
                self.clock(int(k)),
                *(part[i] for part in run.columns),
            )
            for run in self.runs
            for i, k in enumerate(run.which)
        )

    def clock(self, interval: int) -> Clock:
        """Give how an interval reads time."""
        if self.own_clocks is not None:
            base, span = self.own_clocks[interval].tolist()
            return Clock(Scalar(base), Scalar(span), 0.0, 1.0)
        run = next(run for run in self.runs if interval <= run.which[-1])
        i = interval - run.which[0]
        return Clock(self.t0, self.duration, float(run.start[i]), float(run.length[i]))

    @cached_property
    def place_fractions(self) -> Array:
        """Where in the phase every evaluation of the stage function stands; on a moving mesh, before it moves."""
        which, node = self.place_owner.T
        out = np.empty(len(which))
        for run in self.runs:
            chosen = (which >= run.which[0]) & (which <= run.which[-1])
            at = which[chosen] - run.which[0]
            out[chosen] = run.start[at] + run.length[at] * run.scheme.nodes[node[chosen]]
        return out

    @property
    def fractions(self) -> Array:
        """Fractions of the phase where ``knots`` stand: those of the mesh, and in single shooting both ends."""
        return np.concatenate([*(run.start for run in self.runs), [1.0]])

    def breaks(self, w: Array) -> Array:
        """Give the times of the knots for a decision vector w [s], (K + 1,)."""
        t0, duration = self.t0.of(w), self.duration.of(w)
        if not isinstance(self.mesh, MovingMesh):
            return np.asarray(t0 + duration * self.mesh.knots)
        first = [interval.clock.ends(w)[0] for interval in self.intervals]
        return np.array([*first, t0 + duration])


def entries_of(phase: int, variables: Sequence[Variable]) -> list[Entry]:
    """Entries of the NLP for named variables."""
    return [Entry(phase, v.quantity, v.label, v.unit) for v in variables]


def lay_out(phase: Phase, index: int, mesh: Mesh, table: ScalarTable) -> PhaseLayout:
    """Add the columns of a phase to the table, ordered by time, and say where they are."""
    dae = phase.dae
    t0 = _scalar(table, Entry(index, "start time", "", "s"), *((0.0, 0.0) if index == 0 else (0.0, np.inf)))
    duration = _scalar(table, Entry(index, "duration", "", "s"), *phase.duration_bounds)
    parameters = tuple(
        _scalar(table, Entry(index, "parameter", name, ""), low, high)
        for name, low, high in zip(phase.parameter_names, *phase.parameter_bounds, strict=True)
    )
    schemes, breaks = mesh.schemes, mesh.knots
    whole = schemes[0].over(breaks) if isinstance(schemes[0], OneStep) else None
    if whole is not None:
        schemes, breaks = (whole,), np.array([0.0, 1.0])
    lengths = breaks[1:] - breaks[:-1]
    _check_holds(phase, schemes)
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
        # What an interval of the run adds, in this order: controls, algebraic variables, inner states, the knot on its
        # right, corrections; each with where it stands in the interval.
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


def _joins(schemes: Sequence[Any], moving: bool, controlled: bool) -> Iterator[tuple[Indices, Any, _Join]]:
    """Neighbouring intervals of one scheme that share the same with those on their left."""
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
    """What an interval shares with the one on its left: 1 where the first control, or the first place, is theirs."""

    control: int
    place: int

    @classmethod
    def of(cls, here: Any, before: Any, controlled: bool) -> _Join:
        control = here.control_sites[0] == 0.0 and before.control_sites[-1] == 1.0
        # A control that jumps at the knot gives the knot two accelerations: it is evaluated on both sides.
        place = here.nodes[0] == 0.0 and before.nodes[-1] == 1.0 and (control or not controlled)
        return cls(int(control), int(place))


def _check_holds(phase: Phase, schemes: Sequence[Any]) -> None:
    """Refuse schemes that have no collocation point at the end of an interval, where invariants must hold."""
    if not phase.dae.invariants:
        return
    for scheme in schemes:
        if isinstance(scheme, OneStep) or scheme.nodes[-1] != 1.0:
            names = ", ".join(dict.fromkeys(v.label for v in phase.dae.invariants))
            raise InputError(
                f"Phase {phase.name!r} holds {names} at its knots, but {type(scheme).__name__} collocates nothing "
                "there; use a Lobatto or Radau scheme such as rt.HermiteSimpson() or rt.RadauIIA(3)."
            )


def _clocks(breaks: Array, index: int, table: ScalarTable) -> Indices:
    """Add the start and the length of every interval as unknowns."""
    starts = table.add([Entry(index, "start of interval", "", "s")], breaks[:-1])
    spans = table.add([Entry(index, "length of interval", "", "s")], breaks[:-1], 0.0, np.inf)
    return np.hstack([starts, spans])


def _scalar(table: ScalarTable, entry: Entry, low: float, high: float) -> Scalar:
    """Add a column; fixed quantities are constants of the stage functions instead."""
    if low == high:
        return Scalar(None, low)
    return Scalar(int(table.add([entry], np.zeros(1), low, high)[0, 0]))


def _chain(first: Indices, fresh: Indices) -> Indices:
    """Put before each interval's columns (n, m, .) the last of the interval before it, ``first`` before all."""
    return np.concatenate([np.concatenate([first[None], fresh[:-1, -1]])[:, None], fresh], axis=1)
