"""Columns and rows of the NLP under construction, each with its meaning, bounds and time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.row import Measure, Row


@dataclass(frozen=True)
class Entry:
    """Meaning of a column or a row of the NLP.

    Attributes
    ----------
    phase : int
        Index of the phase; of the first phase for a link.
    name : str
        ``"effort limit"``, ``"defect"``, ``"torque balance"`` ...
    label : str
        The joint, frame, state or parameter that it concerns, ``""`` if none.
    unit : str
    measure : Measure or None
        The quantity that reports state in place of the value.
    """

    phase: int
    name: str
    label: str
    unit: str
    measure: Measure | None = None

    @classmethod
    def of(cls, phase: int, row: Row) -> Entry:
        """Return the meaning of a row of a phase."""
        return cls(phase, row.name, row.joint or "", row.unit, row.measure)

    def __str__(self) -> str:
        return f"{self.name}, {self.label}" if self.label else self.name


@dataclass(frozen=True, eq=False)
class Scalars(OneLine):
    """Meaning, time and bounds of n columns or rows.

    Attributes
    ----------
    entries : tuple of Entry
        The distinct meanings.
    meaning : ndarray of int (n,)
        Index into ``entries``.
    fraction : ndarray (n,)
        Place in the phase, 0 at the start and 1 at the end.
    lower, upper : ndarray (n,)
    lower_meaning, upper_meaning : ndarray of int (n,)
        Index of the entry that set each bound, for reports.
    """

    entries: tuple[Entry, ...]
    meaning: Indices
    fraction: Array
    lower: Array
    upper: Array
    lower_meaning: Indices
    upper_meaning: Indices

    def __len__(self) -> int:
        return len(self.meaning)

    def bounded(self, bounds: Sequence[ColumnBound]) -> Scalars:
        """Tighten the bounds; where two contradict each other by round-off, the first one is kept."""
        entries = {entry: i for i, entry in enumerate(self.entries)}
        lower, upper = self.lower.copy(), self.upper.copy()
        lower_meaning, upper_meaning = self.lower_meaning.copy(), self.upper_meaning.copy()
        for bound in bounds:
            number = entries.setdefault(bound.entry, len(entries))
            # Ends come first. A phase accepts an end that exceeds a limit by round-off, and keeps it.
            tighter = bound.columns[bound.lower > lower[bound.columns]]
            lower[tighter], lower_meaning[tighter] = np.minimum(bound.lower, upper[tighter]), number
            tighter = bound.columns[bound.upper < upper[bound.columns]]
            upper[tighter], upper_meaning[tighter] = np.maximum(bound.upper, lower[tighter]), number
        for part in (lower, upper, lower_meaning, upper_meaning):
            part.setflags(write=False)
        return Scalars(tuple(entries), self.meaning, self.fraction, lower, upper, lower_meaning, upper_meaning)

    def joined(self, more: Scalars) -> Scalars:
        """Append the scalars of a table that was started by ``ScalarTable.after`` these."""
        parts = ("meaning", "fraction", "lower", "upper", "lower_meaning", "upper_meaning")
        return Scalars(more.entries, *(np.append(getattr(self, part), getattr(more, part)) for part in parts))


@dataclass
class ScalarTable:
    """Columns or rows while they are added."""

    _entries: dict[Entry, int] = field(default_factory=dict)
    _meaning: list[Indices] = field(default_factory=list)
    _fraction: list[Array] = field(default_factory=list)
    _lower: list[Array] = field(default_factory=list)
    _upper: list[Array] = field(default_factory=list)
    count: int = 0

    @classmethod
    def after(cls, known: Scalars) -> ScalarTable:
        """Return a table whose numbers continue those of a finished one."""
        return cls({entry: i for i, entry in enumerate(known.entries)}, count=len(known))

    def entry(self, entry: Entry) -> int:
        """Return the number of an entry, the same for equal entries."""
        return self._entries.setdefault(entry, len(self._entries))

    def add(
        self, entries: Sequence[Entry], fractions: Array, lower: float | Array = -np.inf, upper: float | Array = np.inf
    ) -> Indices:
        """Add every entry at every fraction; return indices (len(fractions), len(entries))."""
        shape = (len(fractions), len(entries))
        self._meaning.append(np.tile(self.numbers(entries), shape[0]))
        self._fraction.append(np.repeat(np.asarray(fractions, dtype=float), len(entries)))
        self._lower.append(np.full(shape, lower, dtype=float).ravel())
        self._upper.append(np.full(shape, upper, dtype=float).ravel())
        first = self.count
        self.count += shape[0] * shape[1]
        return np.arange(first, self.count).reshape(shape)

    def impose(self, phase: int, rows: Sequence[Row], fractions: Array, room: Array | None = None) -> Indices:
        """Add rows of a phase at every fraction, with ``room`` beyond bounds; return indices, all (fractions, rows)."""
        lower, upper = (np.array([getattr(row, side) for row in rows]) for side in ("lower", "upper"))
        beyond = 0.0 if room is None else room
        return self.add([Entry.of(phase, row) for row in rows], fractions, lower - beyond, upper + beyond)

    def numbers(self, entries: Sequence[Entry]) -> Indices:
        """Return the numbers of entries."""
        return np.array([self.entry(e) for e in entries], dtype=int)

    def add_each(self, numbers: Indices, fractions: Array) -> Indices:
        """Add entry ``numbers[j]`` at ``fractions[i, j]``, row after row, without bounds; return indices (i, j)."""
        self._meaning.append(np.tile(numbers, len(fractions)))
        self._fraction.append(np.asarray(fractions, dtype=float).ravel())
        self._lower.append(np.full(fractions.size, -np.inf))
        self._upper.append(np.full(fractions.size, np.inf))
        first = self.count
        self.count += fractions.size
        return np.arange(first, self.count).reshape(fractions.shape)

    def add_above(self, numbers: Indices, fractions: Array, lower: Array) -> Indices:
        """Add entries ``numbers`` (n,) at fractions (n,) with lower bounds (n,) alone; return indices (n,)."""
        self._meaning.append(numbers)
        self._fraction.append(np.asarray(fractions, dtype=float))
        self._lower.append(np.asarray(lower, dtype=float))
        self._upper.append(np.full(len(numbers), np.inf))
        first = self.count
        self.count += len(numbers)
        return np.arange(first, self.count)

    def finish(self) -> Scalars:
        """Return the scalars as an immutable value."""
        meaning: Indices = np.concatenate([np.empty(0, dtype=int), *self._meaning])
        fraction: Array = np.concatenate([np.empty(0), *self._fraction])
        lower: Array = np.concatenate([np.empty(0), *self._lower])
        upper: Array = np.concatenate([np.empty(0), *self._upper])
        for part in (meaning, fraction, lower, upper):
            part.setflags(write=False)
        return Scalars(tuple(self._entries), meaning, fraction, lower, upper, meaning, meaning)


@dataclass(frozen=True)
class ColumnBound:
    """A bound on columns, and the entry that sets it."""

    entry: Entry
    columns: Indices
    lower: float
    upper: float
