"""Sparse matrices built from triplets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.sparse import csr_array


class Triplets:
    """Entries (row, column, value); values of the same row and column are summed."""

    def __init__(self) -> None:
        self._rows: list[NDArray[np.int_]] = []
        self._columns: list[NDArray[np.int_]] = []
        self._values: list[NDArray[np.float64]] = []

    def add(self, rows: NDArray[np.int_], columns: NDArray[np.int_], value: float | NDArray[np.float64]) -> None:
        """Add ``value`` (a scalar or an array) at the paired rows and columns."""
        self._rows.append(rows)
        self._columns.append(columns)
        values = np.empty(rows.shape)
        values[...] = value
        self._values.append(values)

    def spread(self, rows: NDArray[np.int_], columns: NDArray[np.int_], value: float | NDArray[np.float64]) -> None:
        """Add ``value`` where rows and columns pair up when all three are broadcast."""
        shape = np.broadcast(rows, columns, value).shape
        at = np.empty((2, *shape), dtype=int)
        at[0], at[1] = rows, columns
        values = np.empty(shape)
        values[...] = value
        self.add(at[0].ravel(), at[1].ravel(), values.ravel())

    def matrix(self, shape: tuple[int, int]) -> csr_array:
        """Sum the triplets into a sparse matrix."""
        if not self._rows:
            return csr_array(shape)
        parts = (np.concatenate(self._values), (np.concatenate(self._rows), np.concatenate(self._columns)))
        return csr_array(parts, shape)


def scaled(
    matrix: csr_array, rows: NDArray[np.float64] | None = None, columns: NDArray[np.float64] | None = None
) -> csr_array:
    """Return diag(rows) M diag(columns), on the pattern of M."""
    data = matrix.data
    if rows is not None:
        data = rows.repeat(matrix.indptr[1:] - matrix.indptr[:-1]) * data
    if columns is not None:
        data = data * columns[matrix.indices]
    return csr_array((data, matrix.indices, matrix.indptr), shape=matrix.shape)
