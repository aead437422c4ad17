"""Evaluation of the point functions of all blocks at all their places, on preallocated memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj.native.build import load_native
from robotraj.transcription.assembly.block import Block, Chain

if TYPE_CHECKING:
    from robotraj.native import Csr


class Places:
    """Point functions of blocks at one decision vector w, evaluated on demand and kept until w changes.

    Parameters
    ----------
    blocks : sequence of Block
    functions : sequence of mapping
        For each block the functions of all its places by name, from v (n_v, E), c (n_c, E)[, m (n_y, E)] to (n, E).
    n_w : int
        Length of w.

    Attributes
    ----------
    multipliers : ndarray
        Argument m of "hessian" for all blocks, place after place.
    """

    def __init__(self, blocks: Sequence[Block], functions: Sequence[Mapping[str, ca.Function]], n_w: int) -> None:
        self._blocks, self._functions = blocks, functions
        inputs = [block.stage.inputs * block.count for block in blocks]
        outputs = [block.stage.outputs * block.count for block in blocks]
        self._w, self._v, self.multipliers = np.full(n_w, np.nan), np.zeros(sum(inputs)), np.zeros(sum(outputs))
        self.first_input, self.first_output = _starts(inputs), _starts(outputs)
        self._gather = stacked(
            (len(self._v), n_w),
            [
                (block.gather.row + start, block.gather.col, block.gather.data)
                for block, start in zip(blocks, self.first_input, strict=True)
            ],
        )
        self._calls: dict[str, list[tuple[ca.FunctionBuffer, Callable[[], None]]]] = {}
        self._results: dict[str, Array] = {}
        self._fresh: set[str] = set()
        # CasADi reads and writes these arrays in place.
        self._constants = [np.ascontiguousarray(block.constants.T).ravel() for block in blocks]

    def at(self, w: Array) -> None:
        """Set w."""
        if np.array_equal(w, self._w):
            return
        self._w[:] = w
        self._v[:] = self._gather @ self._w
        self._fresh.clear()

    def sizes(self, name: str) -> list[int]:
        """Return the number of values of ``name`` in each block, over all places; 0 without such a function."""
        return [own[name].numel_out(0) if name in own else 0 for own in self._functions]

    def evaluate(self, name: str) -> Array:
        """Return the values of ``name``, block after block, place after place; the next call overwrites them.

        Raises
        ------
        RuntimeError
            A function cannot be evaluated at this w.
        """
        if name not in self._calls:
            self._prepare(name)
        if name == "hessian" or name not in self._fresh:
            for buffer, run in self._calls[name]:
                run()
                if buffer.ret():
                    raise RuntimeError(f"{name} cannot be evaluated here")
            self._fresh.add(name)
        return self._results[name]

    def combination(self, name: str, chains: Sequence[Chain], slots: Sequence[Indices], rows: int) -> Csr:
        """Return the matrix that sums the values of ``name`` by chains; entry i of a chain is in row slots[i]."""
        sizes = self.sizes(name)
        parts = [
            (slot, chain.source + start, chain.factors)
            for chain, slot, start, size in zip(chains, slots, _starts(sizes), sizes, strict=True)
            if size
        ]
        return stacked((rows, sum(sizes)), parts)

    def _prepare(self, name: str) -> None:
        sizes = self.sizes(name)
        result = self._results[name] = np.zeros(sum(sizes))
        calls = self._calls[name] = []
        for i, (own, start, size) in enumerate(zip(self._functions, _starts(sizes), sizes, strict=True)):
            if not size:
                continue
            block = self._blocks[i]
            arguments = [
                _part(self._v, self.first_input[i], block.stage.inputs * block.count),
                self._constants[i],
                _part(self.multipliers, self.first_output[i], block.stage.outputs * block.count),
            ]
            buffer, run = own[name].buffer()
            for k in range(own[name].n_in()):
                if arguments[k].size:
                    buffer.set_arg(k, _memory(arguments[k]))
            buffer.set_res(0, _memory(_part(result, start, size)))
            calls.append((buffer, run))


def stacked(shape: tuple[int, int], parts: Sequence[tuple[Indices, Indices, Array]]) -> Csr:
    """Return the sparse matrix of triplets (rows, columns, values); those of the same entry are summed."""
    rows, columns = (
        np.concatenate([np.zeros(0, dtype=np.int64), *(part[k].astype(np.int64) for part in parts)]) for k in (0, 1)
    )
    values = np.concatenate([np.zeros(0), *(part[2] for part in parts)])
    matrix: Csr = load_native().Csr.summed(*shape, rows, columns, values)
    return matrix


def _starts(sizes: Sequence[int]) -> list[int]:
    return [0, *accumulate(sizes)][:-1]


def _part(numbers: Array, start: int, size: int) -> Array:
    return numbers[start : start + size]


def _memory(numbers: Array) -> memoryview:
    return numbers.data
