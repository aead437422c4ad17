"""Sparse matrices of the compiled module, ``Csr``: sums of entries, products, rows.

Products and sums take one pass over the entries.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.sparse import csr_array
from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native import Csr

Entries: TypeAlias = tuple[Indices, Indices, Array]
"""Rows, columns and values."""


def native(matrix: csr_array) -> Csr:
    """Copy a matrix of NumPy's arrays."""
    made: Csr = load_native().Csr(*matrix.shape, matrix.indptr, matrix.indices, matrix.data)
    return made


def array(matrix: Csr) -> csr_array:
    """Return a matrix with NumPy's arrays."""
    # Indices of the compiled module have 32 bits.
    indices, starts = cast("Indices", matrix.indices), cast("Indices", matrix.starts)
    return csr_array((matrix.data, indices, starts), (matrix.rows, matrix.columns))


def summed(shape: tuple[int, int], *parts: Entries) -> Csr:
    """Return the matrix with the sums of the entries of all parts, added in their order."""
    rows, columns, data = parts[0] if len(parts) == 1 else map(np.concatenate, zip(*parts, strict=True))
    made: Csr = load_native().Csr.summed(*shape, rows, columns, data)
    return made


def entries(matrix: Csr | csr_array) -> Entries:
    """Return the entries of a matrix, row after row."""
    starts = matrix.indptr if isinstance(matrix, csr_array) else matrix.starts
    counts = starts[1:] - starts[:-1]
    return np.arange(counts.size).repeat(counts), matrix.indices.astype(np.int64), matrix.data


def entries_of(matrix: Csr, rows: Indices) -> Entries:
    """Return the entries of some rows; the row of an entry is its position in ``rows``."""
    starts = matrix.starts[rows].astype(np.int64)
    counts = matrix.starts[rows + 1] - starts
    position = np.arange(rows.size).repeat(counts)
    at = np.arange(position.size) + (starts - counts.cumsum() + counts)[position]
    return position, matrix.indices[at].astype(np.int64), matrix.data[at]


def below(upper: Csr, lower: Csr) -> Csr:
    """Put the rows of one matrix under those of another."""
    made: Csr = load_native().Csr(
        upper.rows + lower.rows,
        upper.columns,
        np.append(upper.starts, upper.entries + lower.starts[1:]),
        np.append(upper.indices, lower.indices),
        np.append(upper.data, lower.data),
    )
    return made


def same(a: Csr, b: Csr) -> bool:
    """Whether two matrices have the same entries, in the same order."""
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("starts", "indices", "data"))
