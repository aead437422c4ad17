"""A transcribed problem during its reduction to stages, in scaled units.

    minimise  c + l' w + sum_b s_b' cost_b     subject to  lower <= L w + offset + sum_b S_b vec(Y_b) <= upper,
                                                           lower <= w <= upper

The first form is the NLP. Every step of the reduction (``linear``, ``controls``) returns an equivalent one. Columns
keep their numbers. Rows that a step eliminates stay in the form without bounds.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices, Mask
from robotraj._util.sparse import csr_array
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.matrices import below, native, same
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import scaled

if TYPE_CHECKING:
    from robotraj.native import Csr
    from robotraj.transcription.nlp import Nlp


@dataclass(frozen=True, eq=False)
class Eliminated:
    """Columns that are expressions of a block: w[columns[e, i]] = factors[e, i] Y_e[outputs[i]].

    Attributes
    ----------
    block : int
        Number of the block.
    outputs : ndarray of int (m,)
        Outputs of the block's point function.
    columns : ndarray of int (E, m)
        Eliminated columns at each of E places.
    factors : ndarray (E, m)
    rows : ndarray of int (E, m)
        The rows of these equations, which are eliminated too.
    """

    block: int
    outputs: Indices
    columns: Indices
    factors: Array
    rows: Indices


@dataclass(frozen=True, eq=False)
class Form:
    """Blocks, linear parts and bounds; see the module.

    Attributes
    ----------
    blocks : tuple of Block
    linear : Csr (n_rows, n_w)
    offset : ndarray (n_rows,)
    cost : ndarray (n_w,)
    constant : float
    row_lower, row_upper : ndarray (n_rows,)
    lower, upper : ndarray (n_w,)
    gone : ndarray of bool (n_w,)
        Whether no row and no block depends on a column any more.
    eliminated : tuple of Eliminated
    targets : ndarray of int (n_rows,)
        The column that a linear row defines (a defect's x_j), -1 where it defines none.
    bound_of : ndarray of int (n_rows,)
        The column whose bound a row is, -1 for other rows.
    limit_of : ndarray of int (n_rows,)
        The row of the NLP whose bound a row is, -1 for bounds of columns. For a row of the NLP it is the row itself.
    """

    blocks: tuple[Block, ...]
    linear: Csr
    offset: Array
    cost: Array
    constant: float
    row_lower: Array
    row_upper: Array
    lower: Array
    upper: Array
    gone: Mask
    eliminated: tuple[Eliminated, ...]
    targets: Indices
    bound_of: Indices
    limit_of: Indices

    @classmethod
    def of(cls, nlp: Nlp) -> Form:
        """Return the form of an NLP in its scaled units."""
        blocks = tuple(block.scaled(nlp.scale, nlp.row_scale) for block in nlp.blocks)
        linear = native(scaled(nlp.linear, nlp.row_scale, nlp.scale))
        n_rows, n_w = nlp.linear.shape
        return cls(
            blocks,
            linear,
            np.zeros(n_rows),
            np.zeros(n_w),
            0.0,
            nlp.rows.lower * nlp.row_scale,
            nlp.rows.upper * nlp.row_scale,
            nlp.variables.lower / nlp.scale,
            nlp.variables.upper / nlp.scale,
            np.zeros(n_w, dtype=bool),
            (),
            _targets(linear),
            np.full(n_rows, -1),
            np.arange(n_rows),
        )

    def nonlinear_entries(self) -> Indices:
        """Return the number of outputs of blocks in each row (n_rows,)."""
        count = np.zeros(len(self.row_lower), dtype=int)
        for block in self.blocks:
            count += np.diff(block.scatter.indptr)
        return count

    def alike(self, other: Form) -> bool:
        """Whether another form differs at most in offsets, in the constants of blocks and in the values of bounds.

        Bounds that are finite, and those that are equal, are the same ones.
        """
        return (
            same(self.linear, other.linear)
            and len(self.blocks) == len(other.blocks)
            and all(_alike(first, second) for first, second in zip(self.blocks, other.blocks, strict=True))
            and all(map(np.array_equal, self._structure, other._structure))
        )

    @property
    def _structure(self) -> list[Array | Mask | Indices]:
        bounds = [(self.row_lower, self.row_upper), (self.lower, self.upper)]
        kinds = [kind for low, high in bounds for kind in (np.isfinite(low), np.isfinite(high), low == high)]
        gone = [part for each in self.eliminated for part in (each.outputs, each.columns, each.factors, each.rows)]
        return [self.cost, self.gone, self.targets, self.bound_of, self.limit_of, *kinds, *gone]


def with_rows(
    form: Form,
    linear: Csr,
    lower: Array,
    upper: Array,
    bound_of: Indices | None = None,
    limit_of: Indices | None = None,
) -> Form:
    """Append rows to a form whose blocks already have them."""
    many = len(lower)
    none = np.full(many, -1)
    return replace(
        form,
        linear=below(form.linear, linear),
        offset=np.append(form.offset, np.zeros(many)),
        row_lower=np.append(form.row_lower, lower),
        row_upper=np.append(form.row_upper, upper),
        targets=np.append(form.targets, none),
        bound_of=np.append(form.bound_of, none if bound_of is None else bound_of),
        limit_of=np.append(form.limit_of, none if limit_of is None else limit_of),
    )


def with_empty_rows(block: Block, more: int) -> Block:
    """Append empty rows to the scatter of a block."""
    scatter = block.scatter
    indptr = np.append(scatter.indptr, np.full(more, scatter.indptr[-1]))
    shape = (scatter.shape[0] + more, scatter.shape[1])
    return replace(block, scatter=csr_array((scatter.data, scatter.indices, indptr), shape=shape))


def _targets(linear: Csr) -> Indices:
    """Return the column x_j of rows whose explicit linear part is x_j - x_0, -1 for all other rows."""
    pairs = np.flatnonzero(np.diff(linear.starts) == 2)
    both = linear.starts[pairs][:, None] + np.arange(2)
    data, columns = linear.data[both], linear.indices[both]
    opposite = data[:, 0] == -data[:, 1]
    targets = np.full(linear.rows, -1)
    chosen = np.argmax(data, axis=1)
    targets[pairs[opposite]] = np.take_along_axis(columns, chosen[:, None], axis=1)[opposite, 0]
    return targets


def _alike(block: Block, other: Block) -> bool:
    """Whether two blocks differ in their constants alone."""
    matrices = ((block.gather, other.gather), (block.scatter, other.scatter))
    return (
        block.stage is other.stage
        and block.constants.shape == other.constants.shape
        and np.array_equal(block.weights, other.weights)
        and all(
            a.shape == b.shape
            and all(np.array_equal(getattr(a, n), getattr(b, n)) for n in ("indptr", "indices", "data"))
            for a, b in matrices
        )
    )
