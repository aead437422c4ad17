"""Sparse matrices in compressed rows: the operations that transcriptions need, with NumPy only.

Names and meanings are those of ``scipy.sparse``, whose import takes longer than a whole plan of an arm. The indices of
a row are sorted and unique. Matrices may share their arrays (``data``, ``indices``, ``indptr``), which are read-only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array, Indices
from robotraj._util.lazy_values import cached_property

if TYPE_CHECKING:
    import scipy.sparse

Shape = tuple[int, int]
Index: TypeAlias = "int | slice | Sequence[int] | NDArray[np.int_] | NDArray[np.bool_]"
"""Rows or columns to take."""
Given: TypeAlias = (
    "csr_array | csc_array | Shape | tuple[Array, tuple[Indices, Indices]] | tuple[Array, Indices, Indices]"
)
"""What a matrix is made from."""


class csr_array:
    """A matrix in compressed rows.

    Parameters
    ----------
    given : csr_array, csc_array, shape, (data, (rows, columns)) or (data, indices, indptr)
        Values of triplets with equal indices are added. Entries of the last form must be sorted.
    shape : (int, int), optional
        Required for the last two forms.
    """

    __array_ufunc__ = None  # NumPy's arrays leave w @ A to this class

    data: Array
    indices: Indices
    indptr: Indices
    shape: Shape

    def __init__(self, given: Given, shape: Shape | None = None) -> None:
        if isinstance(given, csc_array):
            shape = given.shape
            given = given.data, (given.row, given.col)
        elif isinstance(given, csr_array):
            shape = given.shape
            given = given.data, given.indices, given.indptr
        if len(given) == 3:
            assert shape is not None
            self.shape = int(shape[0]), int(shape[1])
            self.data, self.indices, self.indptr = given
            return
        data, places = given
        if isinstance(places, tuple):
            assert shape is not None
            self.shape = int(shape[0]), int(shape[1])
            self.data, self.indices, self.indptr = _compressed(np.asarray(data), *places, self.shape)
        else:
            self.shape = int(data), int(places)
            self.data, self.indices = np.empty(0), np.empty(0, dtype=int)
            self.indptr = np.zeros(self.shape[0] + 1, dtype=int)

    @property
    def nnz(self) -> int:
        """Number of entries."""
        return int(self.data.size)

    @cached_property
    def row(self) -> Indices:
        """Row of every entry."""
        return np.arange(self.shape[0]).repeat(self.indptr[1:] - self.indptr[:-1])

    @property
    def col(self) -> Indices:
        """Column of every entry."""
        return self.indices

    @property
    def T(self) -> csc_array:
        """The transpose."""
        return csc_array(self)

    def tocsc(self) -> csc_array:
        """Return the matrix in compressed columns."""
        turned = (self.data, (self.indices, self.row))
        return csc_array(csr_array(turned, (self.shape[1], self.shape[0])))

    def copy(self) -> csr_array:
        """Return a copy that can be resized."""
        return csr_array(self)

    def resize(self, shape: Shape) -> None:
        """Append empty rows and columns."""
        more = shape[0] - self.shape[0]
        if more < 0 or shape[1] < self.shape[1]:
            raise ValueError(f"A matrix of shape {self.shape} cannot be resized to {shape}; it can only grow.")
        self.indptr = np.append(self.indptr, np.full(more, self.indptr[-1]))
        self.shape = (int(shape[0]), int(shape[1]))
        self.__dict__.pop("row", None)

    def toarray(self) -> Array:
        """Return all entries as a dense array."""
        dense = np.zeros(self.shape)
        dense[self.row, self.indices] = self.data
        return dense

    def scipy(self) -> scipy.sparse.csr_array:
        """Return the matrix as one of SciPy's."""
        from scipy import sparse

        return sparse.csr_array((self.data, self.indices, self.indptr), shape=self.shape)

    def __getitem__(self, rows: Index) -> csr_array:
        """Return rows by indices, a mask or a slice."""
        which = np.atleast_1d(np.arange(self.shape[0])[rows])
        indices, data, position = expand(self, which)
        counts = np.bincount(position, minlength=which.size)
        return csr_array((data, indices, _pointers(counts)), (which.size, self.shape[1]))

    @overload
    def __matmul__(self, other: csr_array) -> csr_array: ...
    @overload
    def __matmul__(self, other: Array) -> Array: ...
    def __matmul__(self, other: csr_array | Array) -> csr_array | Array:
        if not isinstance(other, csr_array):
            return _added(self.row, self.data * other[self.indices], self.shape[0])
        shape = (self.shape[0], other.shape[1])
        columns, factors, position = expand(other, self.indices)
        data, counts = self.data[position] * factors, np.diff(self.indptr)
        if counts.size and counts.max() <= 1:
            taken = np.zeros(shape[0], dtype=int)
            taken[counts > 0] = np.diff(other.indptr)[self.indices]
            return csr_array((data, columns, _pointers(taken)), shape)
        return csr_array((data, (self.row[position], columns)), shape)

    def __rmatmul__(self, other: Array) -> Array:
        return self.T @ other

    def __add__(self, other: csr_array) -> csr_array:
        return _sum(self, other, 1.0)

    def __sub__(self, other: csr_array) -> csr_array:
        return _sum(self, other, -1.0)


class csc_array:
    """A matrix in compressed columns: its transpose in compressed rows."""

    __array_ufunc__ = None

    def __init__(self, transpose: csr_array) -> None:
        self.T = transpose
        self.shape = (transpose.shape[1], transpose.shape[0])
        self.data, self.indices, self.indptr = transpose.data, transpose.indices, transpose.indptr

    @property
    def row(self) -> Indices:
        """Row of every entry."""
        return self.indices

    @property
    def col(self) -> Indices:
        """Column of every entry."""
        return self.T.row

    def __getitem__(self, key: tuple[slice, Index]) -> csc_array:
        """Return columns: ``[:, columns]``."""
        every, columns = key
        if every != slice(None):
            raise ValueError("Only whole columns can be selected; write [:, columns].")
        return csc_array(self.T[columns])

    def __matmul__(self, other: Array) -> Array:
        return _added(self.indices, self.data * other[self.col], self.shape[0])


def diags_array(values: Array) -> csr_array:
    """Return the diagonal matrix."""
    places = np.arange(len(values))
    return csr_array((np.asarray(values), places, np.arange(len(values) + 1)), (len(values), len(values)))


def vstack(parts: Sequence[csr_array]) -> csr_array:
    """Stack matrices of one width."""
    counts = np.concatenate([np.diff(part.indptr) for part in parts])
    data, indices = (np.concatenate([getattr(part, name) for part in parts]) for name in ("data", "indices"))
    return csr_array((data, indices, _pointers(counts)), (counts.size, parts[0].shape[1]))


def expand(matrix: csr_array | csc_array, which: Indices) -> tuple[Indices, Array, Indices]:
    """Concatenate the compressed vectors ``which``: indices, data, and each entry's position in ``which``."""
    starts = matrix.indptr[which]
    counts = matrix.indptr[which + 1] - starts
    if np.all(counts == 1):
        return matrix.indices[starts], matrix.data[starts], np.arange(which.size)
    ends = np.cumsum(counts)
    total = int(ends[-1]) if ends.size else 0
    slots = np.arange(total) - np.repeat(ends - counts, counts) + np.repeat(starts, counts)
    return matrix.indices[slots], matrix.data[slots], np.repeat(np.arange(which.size), counts)


def _compressed(data: Array, rows: Indices, columns: Indices, shape: Shape) -> tuple[Array, Indices, Indices]:
    """Compress triplets to data, indices and pointers; values with equal indices are added in their order."""
    keys = np.asarray(rows, dtype=np.int64) * shape[1] + columns
    data = np.asarray(data, dtype=float)
    if (keys[1:] <= keys[:-1]).any():
        order = np.argsort(keys, kind="stable")
        keys, data = keys[order], data[order]
        fresh = np.ones(keys.size, dtype=bool)
        fresh[1:] = keys[1:] > keys[:-1]
        if not fresh.all():
            data, keys = _added(np.cumsum(fresh) - 1, data), keys[fresh]
    major, minor = np.divmod(keys, max(shape[1], 1))
    return data, minor, _pointers(np.bincount(major, minlength=shape[0]))


def _added(places: Indices, values: Array, size: int = 0) -> Array:
    """Return the sums of the values at each place, added in order."""
    return np.asarray(np.bincount(places, weights=values, minlength=size), dtype=float)


def _pointers(counts: Indices) -> Indices:
    pointers = np.zeros(counts.size + 1, dtype=int)
    counts.cumsum(out=pointers[1:])
    return pointers


def _sum(first: csr_array, second: csr_array, sign: float) -> csr_array:
    """Add two matrices; entries that cancel are removed."""
    if first.shape != second.shape:
        raise ValueError(f"Matrices of shapes {first.shape} and {second.shape} cannot be added.")
    data = np.append(first.data, sign * second.data)
    rows, columns = np.append(first.row, second.row), np.append(first.indices, second.indices)
    total = csr_array((data, (rows, columns)), first.shape)
    kept = total.data != 0.0
    return csr_array((total.data[kept], (total.row[kept], total.col[kept])), first.shape)
