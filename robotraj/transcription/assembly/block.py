"""A block: one point function evaluated at many places of the decision vector.

    Y_e = fn(v_e, c_e),    v_e = (G w)_e,    rows += S vec(Y),    cost += sum_e s_e Y_e[costed]

v_e are the unknowns of the function at place e, linear in w, and c_e its constants. S adds the outputs to rows; s are
the weights of the costed output in the objective.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.printing import OneLine
from robotraj._util.sparse import csr_array, expand
from robotraj._util.values import dataclass
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import scaled


@dataclass(frozen=True, eq=False)
class Block(OneLine):
    """One point function, its places, and the rows and costs to which its outputs are added.

    Attributes
    ----------
    stage : PointFunctions
    gather : sparse (n_v E, n_w)
        G, place after place.
    constants : ndarray (n_c, E)
        c_e as columns.
    scatter : sparse (n_rows, n_y E)
        S.
    weights : ndarray (E,)
        s, zero at places without cost.
    phases : tuple of int
        Phases whose fixed scalars (start time, duration, parameters) are the last constants. Empty where there are
        none, or where the block is added to an NLP later.
    """

    stage: PointFunctions
    gather: csr_array
    constants: Array
    scatter: csr_array
    weights: Array = field(repr=False)
    phases: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """Number of places E."""
        return int(self.constants.shape[1])

    @property
    def costs(self) -> bool:
        """Whether the block adds to the objective."""
        return self.stage.costed is not None and bool(np.any(self.weights))

    def scaled(self, columns: Array, rows: Array) -> Block:
        """Return the block for w = columns * w_scaled and rows_scaled = rows * rows."""
        return replace(
            self,
            gather=scaled(self.gather, columns=columns),
            scatter=scaled(self.scatter, rows=rows),
        )

    def places(self, w: Array) -> Array:
        """Return v at every place, (n_v, E), for a decision vector w."""
        return (self.gather @ w).reshape(self.count, self.stage.inputs).T

    def outputs(self, w: Array) -> Array:
        """Return y at every place, (n_y, E)."""
        return self.stage.evaluate("function", self.places(w), self.constants)

    def rows(self, outputs: Array) -> Array:
        """Return the block's part of the rows, S vec(Y), (n_rows,)."""
        if not self.scatter.nnz:
            return np.zeros(self.scatter.shape[0])
        return np.asarray(self.scatter @ outputs.ravel(order="F"))

    def objective(self, outputs: Array) -> float:
        """Return the block's part of the objective, s' Y[costed]."""
        if not self.costs:
            return 0.0
        return float(outputs[self.stage.costed] @ self.weights)

    def jacobian_chain(self) -> Chain:
        """Return the chain from the nonzeros of the places' Jacobians to S blkdiag(J_e) G."""
        rows, columns = self.stage.jacobian_pattern
        per_place = np.arange(self.count)[:, None]
        y = (per_place * self.stage.outputs + rows[None, :]).ravel()
        x = (per_place * self.stage.inputs + columns[None, :]).ravel()
        by_output = self.scatter.tocsc()
        row, factor, position = expand(by_output, y)
        column, factor_in, inner = expand(self.gather, x[position])
        return Chain(row[inner], column, factor[inner] * factor_in, position[inner])

    def hessian_chain(self) -> Chain:
        """Return the chain from the lower triangles of the places' Hessians to the upper one of G' blkdiag(H_e) G."""
        rows, columns = self.stage.hessian_pattern
        first = np.arange(self.count)[:, None] * self.stage.inputs
        row, factor, position = expand(self.gather, (first + rows).ravel())
        column, factor_in, inner = expand(self.gather, (first + columns).ravel()[position])
        row, factors, source = row[inner], factor[inner] * factor_in, position[inner]
        # An entry off the diagonal represents two. One of them is in the upper triangle, or both are on the diagonal.
        off = np.tile(rows != columns, self.count)[source]
        factors = np.where(off & (row == column), 2.0 * factors, factors)
        kept = off | (row <= column)
        return Chain(np.minimum(row, column)[kept], np.maximum(row, column)[kept], factors[kept], source[kept])


def alike(blocks: Sequence[Block], others: Sequence[Block]) -> bool:
    """Whether blocks are those of one transcription but for their constants."""

    def parts(block: Block) -> tuple[int, ...]:
        return tuple(map(id, (block.stage, block.gather, block.scatter, block.weights)))

    return blocks is others or list(map(parts, blocks)) == list(map(parts, others))


@dataclass(frozen=True)
class Chain:
    """The chain rule as triplets: entry (rows[i], columns[i]) += factors[i] * nonzeros[source[i]]."""

    rows: Indices
    columns: Indices
    factors: Array
    source: Indices
