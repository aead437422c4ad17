"""Derivatives of all rows and of the Lagrangian as sparse combinations of those of the blocks.

vec(J) = j0 + sum_b M_b vec(J_b),    vec(H) = sum_b N_b vec(H_b)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.solvers.stagewise.matrices import entries, summed
from robotraj.transcription.assembly.block import Block, Chain

if TYPE_CHECKING:
    from robotraj.native import Csr


@dataclass(frozen=True, eq=False)
class Combined:
    """Entries in row-major order.

    Attributes
    ----------
    rows, columns : ndarray of int (m,)
    constant : ndarray (m,)
        Linear part of the entries.
    parts : tuple of Csr
        M_b or N_b, (m, nonzeros of all places) for each block.
    """

    rows: Indices
    columns: Indices
    constant: Array
    parts: tuple[Csr, ...]


def jacobian(blocks: Sequence[Block], linear: Csr) -> Combined:
    """Combine linear + sum_b S_b blkdiag(J_b,e) G_b."""
    chains = [block.jacobian_chain() for block in blocks]
    sizes = [block.count * block.stage.jacobian_pattern[0].size for block in blocks]
    return _combined(chains, sizes, entries(linear), linear.columns)


def hessian(blocks: Sequence[Block], columns: int) -> Combined:
    """Combine the upper triangle of sum_b G_b' blkdiag(H_b,e) G_b."""
    chains = [block.hessian_chain() for block in blocks]
    sizes = [block.count * block.stage.hessian_pattern[0].size for block in blocks]
    none = np.zeros(0, dtype=np.int64)
    return _combined(chains, sizes, (none, none, np.zeros(0)), columns)


def _combined(
    chains: Sequence[Chain], sizes: Sequence[int], linear: tuple[Indices, Indices, Array], width: int
) -> Combined:
    row, column, data = linear
    keys = [row.astype(np.int64) * width + column]
    keys += [chain.rows.astype(np.int64) * width + chain.columns for chain in chains]
    unique, slots = np.unique(np.concatenate(keys), return_inverse=True)
    first, *others = np.split(slots, np.cumsum([key.size for key in keys])[:-1])
    constant = np.asarray(np.bincount(first, weights=data, minlength=unique.size), dtype=np.float64)
    parts = [
        summed((unique.size, size), (slot, chain.source.astype(np.int64), chain.factors))
        for chain, slot, size in zip(chains, others, sizes, strict=True)
    ]
    return Combined(unique // width, unique % width, constant, tuple(parts))
