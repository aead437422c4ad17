"""Where the unknowns of a phase stand in the decision vector.

States stand at knots and at the inner nodes of each interval, algebraic variables at nodes, controls at the control's
sites. Where the schemes on both sides of a knot have a node (or a control site) there, the neighbours share the value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
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


@dataclass(frozen=True, eq=False)
class PhaseLayout:
    """Columns of one phase.

    Attributes
    ----------
    knots : Indices (K + 1, nx)
        In single shooting, whose phase is one interval, those of both ends.
    intervals : tuple of IntervalLayout
    t0, duration : Scalar
    parameters : tuple of Scalar
    place_owner : tuple of (int, int)
        For every evaluation of the stage function, an interval and a node that use it.
    """

    mesh: Mesh
    knots: Indices
    intervals: tuple[IntervalLayout, ...]
    t0: Scalar
    duration: Scalar
    parameters: tuple[Scalar, ...]
    place_owner: tuple[tuple[int, int], ...]

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """The intervals, those of one scheme that follow each other together."""
        found = []
        for _, group in groupby(range(len(self.intervals)), key=lambda k: self.intervals[k].scheme):
            which = np.array(list(group))
            own = [self.intervals[k] for k in which]
            names = ("start", "length", "states", "left", "right", "algebraic", "controls", "places", "corrections")
            start, length, *columns = (np.array([getattr(interval, name) for interval in own]) for name in names)
            clock_length = np.array([interval.clock.length for interval in own])
            found.append(Run(own[0].scheme, which, start, length, clock_length, *columns))
        return tuple(found)

    @cached_property
    def place_fractions(self) -> Array:
        """Where in the phase every evaluation of the stage function stands; on a moving mesh, before it moves."""
        which, node = np.array(self.place_owner).T
        out = np.empty(len(which))
        for run in self.runs:
            chosen = (which >= run.which[0]) & (which <= run.which[-1])
            at = which[chosen] - run.which[0]
            out[chosen] = run.start[at] + run.length[at] * run.scheme.nodes[node[chosen]]
        return out

    @property
    def fractions(self) -> Array:
        """Fractions of the phase where ``knots`` stand: those of the mesh, and in single shooting both ends."""
        return np.array([*(interval.start for interval in self.intervals), 1.0])

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
    x, z, u = (entries_of(index, group) for group in (dae.states, dae.algebraic, dae.controls))
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
    lengths = np.diff(breaks)
    invariants = [Entry(index, "correction", v.label, v.unit) for v in dae.invariants]
    _check_holds(phase, schemes)
    knots = [table.add(x, breaks[:1])[0]]
    clocks = _clocks(mesh, breaks, index, t0, duration, table)
    moving = isinstance(mesh, MovingMesh)
    intervals: list[IntervalLayout] = []
    owners: list[tuple[int, int]] = []
    joins = [_Join.of(schemes, k, moving, bool(u)) for k in range(len(schemes))]
    for (scheme, join), run in groupby(range(len(schemes)), key=lambda k: (schemes[k], joins[k])):
        which = np.array(list(run))
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
        at = np.concatenate([np.repeat(where, len(group)) for group, where in parts])
        fractions = breaks[which, None] + lengths[which, None] * at
        sizes = [len(group) * len(where) for group, where in parts]
        ends = np.cumsum(sizes)
        fractions[:, ends[2] : ends[3]] = breaks[which + 1, None]
        added = table.add_each([entry for group, where in parts for _ in where for entry in group], fractions)
        controls, algebraic, inside, right, corrections = (
            part.reshape(len(which), len(where), len(group))
            for part, (group, where) in zip(np.split(added, ends[:-1], axis=1), parts, strict=True)
        )
        before = intervals[-1] if intervals else None
        if join.control and before is not None:
            controls = _chain(before.controls[-1], controls)
        if join.place and before is not None:
            algebraic = _chain(before.algebraic[-1], algebraic)
        left = np.vstack([knots[-1][None], right[:-1, 0]])
        states = np.empty((len(which), len(nodes), len(x)), dtype=int)
        states[:, inner] = inside
        states[:, nodes == 0.0], states[:, nodes == 1.0] = left[:, None], right
        fresh = len(nodes) - join.place
        places = len(owners) + np.arange(len(which) * fresh).reshape(len(which), fresh)
        if join.place and before is not None:
            places = _chain(before.places[-1:], places[:, :, None])[:, :, 0]
        owners += [(int(k), j) for k in which for j in range(join.place, len(nodes))]
        knots += list(right[:, 0])
        columns = (states, left, right[:, 0], algebraic, controls, places, corrections)
        intervals += [
            IntervalLayout(scheme, breaks[k], lengths[k], clocks[k], *(part[i] for part in columns))
            for i, k in enumerate(which)
        ]
    return PhaseLayout(mesh, np.array(knots), tuple(intervals), t0, duration, parameters, tuple(owners))


@dataclass(frozen=True)
class _Join:
    """What an interval shares with the one on its left: 1 where the first control, or the first place, is theirs."""

    control: int
    place: int

    @classmethod
    def of(cls, schemes: Sequence[Any], k: int, moving: bool, controlled: bool) -> _Join:
        if moving or k == 0:
            return cls(0, 0)
        here, before = schemes[k], schemes[k - 1]
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


def _clocks(mesh: Mesh, breaks: Array, index: int, t0: Scalar, duration: Scalar, table: ScalarTable) -> list[Clock]:
    """Clocks of all intervals; a moving mesh adds the start and the length of each as unknowns."""
    lengths = np.diff(breaks)
    if not isinstance(mesh, MovingMesh):
        return [Clock(t0, duration, float(a), float(d)) for a, d in zip(breaks[:-1], lengths, strict=True)]
    starts = table.add([Entry(index, "start of interval", "", "s")], breaks[:-1])[:, 0]
    spans = table.add([Entry(index, "length of interval", "", "s")], breaks[:-1], 0.0, np.inf)[:, 0]
    return [Clock(Scalar(int(a)), Scalar(int(d)), 0.0, 1.0) for a, d in zip(starts, spans, strict=True)]


def _scalar(table: ScalarTable, entry: Entry, low: float, high: float) -> Scalar:
    """Add a column; fixed quantities are constants of the stage functions instead."""
    if low == high:
        return Scalar(None, low)
    return Scalar(int(table.add([entry], np.zeros(1), low, high)[0, 0]))


def _chain(first: Indices, fresh: Indices) -> Indices:
    """Put before each interval's columns (n, m, .) the last of the interval before it, ``first`` before all."""
    return np.concatenate([np.vstack([first[None], fresh[:-1, -1]])[:, None], fresh], axis=1)
