"""A block: one stage function evaluated at many places of the decision vector.

    Y_e = fn(v_e, c_e),    v_e = (G w)_e,    rows += S vec(Y),    cost += sum_e s_e Y_e[costed]

v_e gathers the unknowns the function reads at place e (linear in w), c_e are constants, S scatters the outputs into
rows and s weighs the costed output in the objective.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from robotraj.transcription.stage import Stage

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True, eq=False)
class Block:
    """One stage function, its places, and where its outputs go.

    Attributes
    ----------
    stage : Stage
    gather : sparse (n_v E, n_w)
        G, place after place.
    constants : ndarray (n_c, E)
        c_e as columns.
    scatter : sparse (n_rows, n_y E)
        S.
    weights : ndarray (E,)
        s, zero where the place costs nothing.
    """

    stage: Stage
    gather: sparse.csr_array
    constants: Array
    scatter: sparse.csr_array
    weights: Array = field(repr=False)

    @property
    def count(self) -> int:
        """Number of places E."""
        return int(self.constants.shape[1])

    @property
    def costs(self) -> bool:
        """Whether the block has a part in the objective."""
        return self.stage.costed is not None and bool(np.any(self.weights))

    def scaled(self, columns: Array, rows: Array) -> Block:
        """Rewrite the block for w = columns * w_scaled and rows_scaled = rows * rows."""
        return replace(
            self,
            gather=sparse.csr_array(self.gather @ sparse.diags_array(columns)),
            scatter=sparse.csr_array(sparse.diags_array(rows) @ self.scatter),
        )

    def places(self, w: Array) -> Array:
        """Values of v at every place, (n_v, E), for a decision vector w."""
        return (self.gather @ w).reshape(self.count, self.stage.inputs).T

    def outputs(self, w: Array) -> Array:
        """Values of y at every place, (n_y, E)."""
        mapped = self.stage.function.map(self.count)
        return np.array(mapped(self.places(w), self.constants)).reshape(self.stage.outputs, self.count)

    def jacobian_chain(self) -> Chain:
        """Where the nonzeros of the places' Jacobians go in S blkdiag(J_e) G."""
        rows, columns = self.stage.jacobian_pattern
        per_place = np.arange(self.count)[:, None]
        y = (per_place * self.stage.outputs + rows[None, :]).ravel()
        x = (per_place * self.stage.inputs + columns[None, :]).ravel()
        by_output = self.scatter.tocsc()
        row, factor, position = _expand(by_output, y)
        column, factor_in, inner = _expand(self.gather, x[position])
        return Chain(row[inner], column, factor[inner] * factor_in, position[inner])

    def hessian_chain(self) -> Chain:
        """Where the lower triangles of the places' Hessians go in the upper triangle of G' blkdiag(H_e) G."""
        rows, columns = self.stage.hessian_pattern
        off = rows != columns
        both_rows = np.concatenate([rows, columns[off]])
        both_columns = np.concatenate([columns, rows[off]])
        entry = np.concatenate([np.arange(rows.size), np.flatnonzero(off)])
        per_place = np.arange(self.count)[:, None]
        a = (per_place * self.stage.inputs + both_rows[None, :]).ravel()
        b = (per_place * self.stage.inputs + both_columns[None, :]).ravel()
        source = (per_place * rows.size + entry[None, :]).ravel()
        row, factor, position = _expand(self.gather, a)
        column, factor_in, inner = _expand(self.gather, b[position])
        upper = row[inner] <= column
        factors = factor[inner] * factor_in
        return Chain(row[inner][upper], column[upper], factors[upper], source[position][inner][upper])


@dataclass(frozen=True)
class Chain:
    """The chain rule as triplets: entry (rows[i], columns[i]) += factors[i] * nonzeros[source[i]]."""

    rows: Indices
    columns: Indices
    factors: Array
    source: Indices


def _expand(matrix: sparse.csr_array | sparse.csc_array, which: Indices) -> tuple[Indices, Array, Indices]:
    """Concatenate the compressed vectors ``which``: indices, data, and each entry's position in ``which``."""
    starts = matrix.indptr[which]
    counts = matrix.indptr[which + 1] - starts
    ends = np.cumsum(counts)
    total = int(ends[-1]) if ends.size else 0
    slots = np.arange(total) - np.repeat(ends - counts, counts) + np.repeat(starts, counts)
    return matrix.indices[slots], matrix.data[slots], np.repeat(np.arange(which.size), counts)
