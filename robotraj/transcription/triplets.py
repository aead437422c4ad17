"""Sparse matrices under construction, as triplets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotraj.sparse import csr_array


class Triplets:
    """Entries (row, column, value) that add up."""

    def __init__(self) -> None:
        self._rows: list[NDArray[np.int_]] = []
        self._columns: list[NDArray[np.int_]] = []
        self._values: list[NDArray[np.float64]] = []

    def add(self, rows: NDArray[np.int_], columns: NDArray[np.int_], value: Any) -> None:
        """Add ``value`` (a scalar or an array) at the paired rows and columns."""
        self._rows.append(rows)
        self._columns.append(columns)
        self._values.append(np.full(rows.shape, value, dtype=float))

    def spread(self, rows: NDArray[np.int_], columns: NDArray[np.int_], value: Any) -> None:
        """Add ``value`` where rows and columns pair up when all three are broadcast."""
        every = np.broadcast_arrays(rows, columns, np.asarray(value, dtype=float))
        self.add(*(part.ravel() for part in every))

    def matrix(self, shape: tuple[int, int]) -> csr_array:
        """Sum the triplets into a sparse matrix."""
        if not self._rows:
            return csr_array(shape)
        parts = (np.concatenate(self._values), (np.concatenate(self._rows), np.concatenate(self._columns)))
        return csr_array(parts, shape)


def scaled(
    matrix: csr_array, rows: NDArray[np.float64] | None = None, columns: NDArray[np.float64] | None = None
) -> csr_array:
    """Give diag(rows) M diag(columns), on the pattern of M."""
    data = matrix.data
    if rows is not None:
        data = np.repeat(rows, np.diff(matrix.indptr)) * data
    if columns is not None:
        data = data * columns[matrix.indices]
    return csr_array((data, matrix.indices, matrix.indptr), shape=matrix.shape)
