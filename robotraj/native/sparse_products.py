"""Sparse matrices with entries in a buffer; their products as terms buffer[out] += buffer[left] * buffer[right].

The chain rule of a stage function is written as a list of such terms when its block is made. The compiled module
evaluates the list at every point.
"""

from __future__ import annotations

from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass

Indices = NDArray[np.int64]
Sums = tuple[Indices, Indices, Indices, Indices]
"""Terms of a matrix: row, column, left and right of each."""

ONE = 0
"""The place of the constant 1 in every buffer."""


@dataclass(frozen=True, eq=False)
class Entries:
    """A sparse matrix: entry (rows[i], columns[i]) is at ``places[i]`` of the buffer."""

    rows: Indices
    columns: Indices
    places: Indices

    @property
    def T(self) -> Entries:
        """The transpose."""
        return Entries(self.columns, self.rows, self.places)

    def where(self, kept: NDArray[np.bool_]) -> Entries:
        """Keep some entries."""
        return Entries(self.rows[kept], self.columns[kept], self.places[kept])

    def __len__(self) -> int:
        return len(self.rows)


def entries(rows: Indices, columns: Indices, first: int) -> Entries:
    """Return the matrix whose entries follow each other from place ``first``."""
    places = np.arange(first, first + len(rows), dtype=np.int64)
    return Entries(np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64), places)


def joined(a: Entries, b: Entries) -> Entries:
    """Return all entries of both."""
    return Entries(*(np.concatenate(side) for side in ((a.rows, b.rows), (a.columns, b.columns), (a.places, b.places))))


@dataclass
class Terms:
    """A growing buffer, and the terms that are summed in it.

    Attributes
    ----------
    size : int
        Length of the buffer so far.
    """

    size: int
    _terms: list[NDArray[np.int64]] = field(default_factory=list)

    def collect(self, sums: list[Sums], full: int | None = None) -> Entries:
        """Append a matrix of sums of terms (row, column, left, right).

        Parameters
        ----------
        full : int, optional
            Return a dense column of this length instead, with zeros where there is no term.

        Returns
        -------
        Entries
            In column-major order.
        """
        rows, columns, left, right = (np.concatenate(side) for side in zip(*sums, strict=True))
        key = columns * (rows.max(initial=0) + 1) + rows
        ranked = key.argsort(kind="stable")
        fresh = np.ones(len(key), dtype=bool)
        fresh[1:] = key[ranked[1:]] > key[ranked[:-1]]
        first = ranked[fresh]
        which = np.empty(len(key), dtype=np.int64)
        which[ranked] = fresh.cumsum() - 1
        if full is None:
            made = entries(rows[first], columns[first], self.size)
        else:
            made = entries(np.arange(full), np.zeros(full, dtype=np.int64), self.size)
            which = rows
        self.size += len(made)
        self._terms.append(np.stack([made.places[which], left, right]))
        return made

    def product(self, a: Entries, b: Entries) -> Entries:
        """Append the product a b."""
        return self.collect([matched(a, b)])

    @property
    def terms(self) -> NDArray[np.int64]:
        """Out, left and right of every term, (3, terms), in order."""
        return np.concatenate(self._terms, axis=1) if self._terms else np.zeros((3, 0), dtype=np.int64)


def copied(a: Entries) -> Sums:
    """Return the terms of a copy of a."""
    return a.rows, a.columns, a.places, np.full(len(a), ONE, dtype=np.int64)


def matched(a: Entries, b: Entries) -> Sums:
    """Return the terms of a b: pairs of entries where the row in b is the column in a."""
    by_row = np.argsort(b.rows, kind="stable")
    begin = np.searchsorted(b.rows[by_row], a.columns, "left")
    many = np.searchsorted(b.rows[by_row], a.columns, "right") - begin
    left = np.repeat(np.arange(len(a)), many)
    right = by_row[np.arange(len(left)) - np.repeat(np.cumsum(many) - many, many) + np.repeat(begin, many)]
    return a.rows[left], b.columns[right], a.places[left], b.places[right]


def lower(terms: Sums) -> Sums:
    """Keep the terms of the lower triangle."""
    rows, columns, left, right = terms
    kept = rows >= columns
    return rows[kept], columns[kept], left[kept], right[kept]


def flipped(terms: Sums) -> Sums:
    """Return the terms of the transpose."""
    rows, columns, left, right = terms
    return columns, rows, left, right
