"""Outputs of point functions that are linear in the unknowns become linear rows and costs of the problem.

By inverse dynamics the rates (v, a) are linear. The defects of a fixed duration then depend on no block.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.native.build import load_native
from robotraj.native.stage_tapes import Pattern, plain
from robotraj.solvers.stagewise.form import Form
from robotraj.solvers.stagewise.matrices import array, entries, native, summed
from robotraj.solvers.stagewise.stage_cache import StageCache
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.function_parts import restricted
from robotraj.transcription.assembly.point_functions import PointFunctions

if TYPE_CHECKING:
    from robotraj.native import Csr
    from robotraj.native._native import Recipe


@dataclass(frozen=True, eq=False)
class _Parts:
    """Linear outputs A(c) v + b(c) of point functions, and the others as ``rest``.

    ``linear`` gives the nonzeros of A, then b. ``rest`` is None where all outputs are linear.
    """

    outputs: Indices
    linear: Recipe
    pattern: Pattern
    rest: PointFunctions | None


_SPLIT: StageCache[_Parts] = StageCache()


def extract_linear(form: Form) -> Form:
    """Move every output that is linear into ``linear``, ``offset``, ``cost`` and ``constant``."""
    n_rows, n_w = form.linear.rows, form.linear.columns
    blocks, offset = [], form.offset.copy()
    linear = form.linear
    cost, constant = form.cost.copy(), form.constant
    for block in form.blocks:
        parts = _SPLIT.get(block.stage, None, partial(_split_outputs, block.stage))
        chosen = parts.outputs
        if not chosen.size:
            blocks.append(block)
            continue
        matrix, values = _linear_part(block, parts)
        count, outputs, m = block.count, block.stage.outputs, chosen.size
        # Columns of S are numbered among the linear outputs and among the others.
        row, column, data = entries(block.scatter)
        place, output = np.divmod(column, outputs)
        number = np.full(outputs, -1)
        number[chosen] = np.arange(m)
        taken = number[output] >= 0
        mine = summed((n_rows, count * m), (row[taken], (place * m + number[output])[taken], data[taken]))
        linear = summed((n_rows, n_w), entries(linear), entries(mine @ matrix)).pruned()
        offset += mine @ values
        costed = block.stage.costed
        if costed is not None and costed in chosen:
            weights = np.zeros((count, m))
            weights[:, number[costed]] = block.weights
            cost += matrix.transposed() @ weights.ravel()
            constant += float(weights.ravel() @ values)
        if parts.rest is None:
            continue
        number[:] = -1
        number[np.delete(np.arange(outputs), chosen)] = np.arange(outputs - m)
        left = row[~taken], (place * (outputs - m) + number[output])[~taken], data[~taken]
        rest = replace(block, stage=parts.rest, scatter=array(summed((n_rows, count * (outputs - m)), left)))
        if rest.scatter.nnz or rest.costs:
            blocks.append(rest)
    return replace(form, blocks=tuple(blocks), linear=linear, offset=offset, cost=cost, constant=constant)


def _split_outputs(stage: PointFunctions) -> _Parts:
    curved, linear, pattern = stage.graph.split()
    rest = restricted(stage, curved.tolist()) if curved.size else None
    return _Parts(np.delete(np.arange(stage.outputs), curved), plain(linear), pattern, rest)


def _linear_part(block: Block, parts: _Parts) -> tuple[Csr, Array]:
    """Return the matrix (E m, n_w) and constants (E m,) of m linear outputs at E places."""
    count, m = block.count, parts.outputs.size
    rows, columns = parts.pattern
    constants = np.ascontiguousarray(block.constants.T).ravel()
    evaluator = load_native().TapeBlock(count, 0, block.constants.shape[0], parts.linear)
    numbers = evaluator.values(np.zeros(0), constants).reshape(count, -1)
    nonzeros, values = numbers[:, : rows.size], numbers[:, rows.size :]
    place = np.arange(count)[:, None]
    at = (place * m + rows).ravel(), (place * block.stage.inputs + columns).ravel(), nonzeros.ravel()
    return summed((count * m, count * block.stage.inputs), at) @ native(block.gather), values.ravel()
