"""Layout of a phase: the columns of its unknowns in the decision vector, which ``numbering`` assigns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.transcription.scalar_table import Entry
from robotraj.transcription.schemes.collocation import Scheme
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh


@dataclass(frozen=True)
class Scalar:
    """A quantity that is a column of the NLP, or a constant where its bounds fix it."""

    column: int | None
    value: float = 0.0

    def of(self, w: Array) -> float:
        """Return the value for a decision vector w in physical units."""
        return self.value if self.column is None else float(w[self.column])


@dataclass(frozen=True)
class Clock:
    """Time on an interval: t = base + (start + length c) span, for c in [0, 1].

    On a fixed mesh base and span are those of the phase, on a moving mesh they are the interval's own unknowns.
    """

    base: Scalar
    span: Scalar
    start: float
    length: float

    def ends(self, w: Array) -> tuple[float, float]:
        """Return the first and the last time of the interval for a decision vector w [s]."""
        first = self.base.of(w) + self.start * self.span.of(w)
        return first, first + self.length * self.span.of(w)


@dataclass(frozen=True, eq=False)
class IntervalLayout:
    """Columns of one interval.

    Attributes
    ----------
    scheme : Scheme
    start, length : float
        Fractions of the phase; on a moving mesh, those of its guess.
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
        Number of the evaluation of the stage function at each node.
    corrections : Indices (r, ni)
        Columns of the corrections that hold the invariants, at the r nodes above 0; each belongs to its node's place.
    """

    scheme: Scheme
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

    scheme: Scheme
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
        """Arrays of the columns, in the order of the fields of ``IntervalLayout``."""
        return self.states, self.left, self.right, self.algebraic, self.controls, self.places, self.corrections

    def joined(self, other: Run) -> Run:
        """Return this run and the next one of the same scheme as one run."""
        which = np.concatenate([self.which, other.which])
        times = (
            np.concatenate([getattr(run, name) for run in (self, other)])
            for name in ("start", "length", "clock_length")
        )
        columns = (np.concatenate(pair) for pair in zip(self.columns, other.columns, strict=True))
        return Run(self.scheme, which, *times, *columns)


@dataclass(frozen=True, eq=False)
class PhaseLayout(OneLine):
    """Columns of one phase.

    Attributes
    ----------
    knots : Indices (K + 1, nx)
        Columns of the state at the knots; in single shooting, whose phase is one interval, at both ends.
    runs : tuple of Run
        Neighbouring intervals of one scheme.
    t0, duration : Scalar
    parameters : tuple of Scalar
    place_owner : Indices (places, 2)
        An interval and a node for every evaluation of the stage function.
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
    def scheme(self) -> Scheme:
        """The scheme of the first interval."""
        return self.runs[0].scheme

    @property
    def count(self) -> int:
        """Number of intervals K."""
        return len(self.knots) - 1

    @cached_property
    def intervals(self) -> tuple[IntervalLayout, ...]:
        """The intervals, one by one."""
        return tuple(self.interval(k) for k in range(self.runs[-1].which[-1] + 1))

    def interval(self, number: int) -> IntervalLayout:
        """Return one interval; -1 is the last one. Much cheaper than ``intervals`` where a few are read."""
        run, i = self._in_run(number)
        columns = (part[i] for part in run.columns)
        return IntervalLayout(run.scheme, run.start[i], run.length[i], self.clock(number), *columns)

    def clock(self, interval: int) -> Clock:
        """Return the clock of an interval; -1 is the last one."""
        if self.own_clocks is not None:
            base, span = self.own_clocks[interval].tolist()
            return Clock(Scalar(base), Scalar(span), 0.0, 1.0)
        run, i = self._in_run(interval)
        return Clock(self.t0, self.duration, float(run.start[i]), float(run.length[i]))

    def _in_run(self, interval: int) -> tuple[Run, int]:
        """Return the run of an interval, and its number in that run."""
        if interval < 0:
            interval += int(self.runs[-1].which[-1]) + 1
        run = next(run for run in self.runs if interval <= run.which[-1])
        return run, interval - int(run.which[0])

    @cached_property
    def place_fractions(self) -> Array:
        """Fraction of the phase of every evaluation of the point function; on a moving mesh, that of its guess."""
        which, node = self.place_owner.T
        out = np.empty(len(which))
        for run in self.runs:
            chosen = (which >= run.which[0]) & (which <= run.which[-1])
            at = which[chosen] - run.which[0]
            out[chosen] = run.start[at] + run.length[at] * run.scheme.nodes[node[chosen]]
        return out

    @property
    def fractions(self) -> Array:
        """Fractions of the phase of ``knots``: those of the mesh, in single shooting both ends."""
        return np.concatenate([*(run.start for run in self.runs), [1.0]])

    def breaks(self, w: Array) -> Array:
        """Return the times of the knots for a decision vector w [s], (K + 1,)."""
        t0, duration = self.t0.of(w), self.duration.of(w)
        if not isinstance(self.mesh, MovingMesh):
            return np.asarray(t0 + duration * self.mesh.knots)
        first = [interval.clock.ends(w)[0] for interval in self.intervals]
        return np.array([*first, t0 + duration])


def entries_of(phase: int, variables: Sequence[Variable]) -> list[Entry]:
    """Return the entries of named variables."""
    return [Entry(phase, v.quantity, v.label, v.unit) for v in variables]
