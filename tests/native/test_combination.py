"""Sparse combinations against dense products: repetition changes their memory only, not their values."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray

from robotraj.native.build import load_native

Array = NDArray[np.float64]
NATIVE: Any = load_native()
each_processor = pytest.mark.parametrize("processor", NATIVE.processors())


def native(matrix: Any) -> Any:
    """Return the matrix in the format of the compiled module."""
    a = sp.csr_matrix(matrix)
    a.sort_indices()
    return NATIVE.Csr(*a.shape, a.indptr.astype(np.int64), a.indices.astype(np.int64), a.data)


def staircase(stages: int, rows: int, columns: int, overlap: int, rng: np.random.Generator) -> sp.csr_matrix:
    """The same block in every stage, each ``columns`` further on, some rows of it empty."""
    block = sp.random(rows, columns + overlap, 0.3, random_state=rng, data_rvs=rng.standard_normal).tocoo()
    k = np.repeat(np.arange(stages), block.nnz)
    row, column = np.tile(block.row, stages) + k * rows, np.tile(block.col, stages) + k * columns
    shape = (stages * rows, stages * columns + overlap)
    return sp.csr_matrix((np.tile(block.data, stages), (row, column)), shape=shape)


def random_rows(count: int, columns: int, rng: np.random.Generator) -> sp.csr_matrix:
    return sp.random(count, columns, 0.1, random_state=rng, data_rvs=rng.standard_normal).tocsr()


@each_processor
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("stages", [1, 4, 8, 30, 400])
def test_blocks_that_repeat_are_kept_once(stages: int, threads: int, processor: str) -> None:
    rng = np.random.default_rng(stages)
    matrix = staircase(stages, 40, 25, 12, rng)
    made = NATIVE.Combination(native(matrix), processor=processor)
    x, base = rng.standard_normal(matrix.shape[1]), rng.standard_normal(matrix.shape[0])
    np.testing.assert_allclose(made.apply(x, base, threads), base + matrix @ x, rtol=1e-13, atol=1e-13)
    assert made.entries == (matrix.nnz if stages < 4 else matrix.nnz // stages)


def test_sections_and_what_lies_between_them() -> None:
    """Two staircases, with irregular rows before, between and after them, as of a first and a last stage."""
    rng = np.random.default_rng(5)
    first, second = staircase(50, 33, 20, 0, rng), staircase(50, 17, 20, 0, rng)
    rest = [random_rows(count, first.shape[1], rng) for count in (70, 45, 90)]
    matrix = sp.vstack([rest[0], first, rest[1], second, rest[2]]).tocsr()
    made = NATIVE.Combination(native(matrix))
    x, base = rng.standard_normal(matrix.shape[1]), rng.standard_normal(matrix.shape[0])
    np.testing.assert_allclose(made.apply(x, base), base + matrix @ x, rtol=1e-13, atol=1e-13)
    assert made.entries < 0.1 * (first.nnz + second.nnz) + sum(part.nnz for part in rest)


def test_one_number_that_differs_is_not_taken_for_the_others() -> None:
    rng = np.random.default_rng(7)
    matrix = staircase(60, 40, 25, 12, rng)
    x, base = rng.standard_normal(matrix.shape[1]), np.zeros(matrix.shape[0])
    for entry in (0, matrix.nnz // 2, matrix.nnz - 1):
        changed = matrix.copy()
        changed.data[entry] += 1.0
        made = NATIVE.Combination(native(changed))
        np.testing.assert_allclose(made.apply(x, base), changed @ x, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("rows", [0, 1, 15, 129])
def test_empty_rows_leave_the_base(rows: int) -> None:
    made = NATIVE.Combination(native(sp.csr_matrix((rows, 3))))
    base = np.arange(rows, dtype=float)
    np.testing.assert_array_equal(made.apply(np.ones(3), base), base)
    assert made.entries == 0


@each_processor
@pytest.mark.parametrize("rows", [7, 40])
def test_results_may_have_places_of_their_own(rows: int, processor: str) -> None:
    rng = np.random.default_rng(rows)
    matrix = staircase(50, rows, 25, 12, rng)
    # Every stage leaves a gap, its first two rows are dropped, and one row has another place than those like it.
    places = np.arange(matrix.shape[0]) + 3 * np.repeat(np.arange(50), rows)
    places[np.arange(matrix.shape[0]) % rows < 2] = -1
    places[31 * rows + 5] = 60 * rows
    made = NATIVE.Combination(native(matrix), places.astype(np.int32), processor=processor)
    x, expected = rng.standard_normal(matrix.shape[1]), rng.standard_normal(60 * rows + 200)
    found = made.apply(x, expected)
    np.add.at(expected, places[places >= 0], (matrix @ x)[places >= 0])
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)
    assert made.entries < 0.2 * matrix.nnz
    with pytest.raises(ValueError, match=f"places has 3 entries, expected {matrix.shape[0]}"):
        NATIVE.Combination(native(matrix), np.zeros(3, dtype=np.int32))


@each_processor
@pytest.mark.parametrize("stages", [3, 50])
def test_a_base_that_stays_is_kept_with_the_rows(stages: int, processor: str) -> None:
    rng = np.random.default_rng(stages)
    matrix = staircase(stages, 40, 25, 12, rng)
    x, base = rng.standard_normal(matrix.shape[1]), np.tile(rng.standard_normal(40), stages)
    for stage in range(0, stages, 20):  # a number that differs is not taken for the others
        base[40 * stage + 7] += 1.0
    other = rng.standard_normal(matrix.shape[0])
    for order in (np.arange(matrix.shape[0]), np.arange(matrix.shape[0])[::-1]):
        made = NATIVE.Combination(native(matrix), order.astype(np.int32), base, processor)
        product = (matrix @ x)[order]
        np.testing.assert_allclose(made.apply(x, None, size=len(base)), base[order] + product, rtol=1e-13, atol=1e-13)
        np.testing.assert_allclose(made.apply(x, other), other + product, rtol=1e-13, atol=1e-13)
        assert made.entries < matrix.nnz / 2 or stages == 3


def test_another_processor_is_refused() -> None:
    with pytest.raises(ValueError, match="does not run what was compiled for 'abacus'"):
        NATIVE.Combination(native(sp.csr_matrix((3, 3))), processor="abacus")


def test_definitions_may_be_a_chain_of_any_length() -> None:
    """x_i = x_(i + 1), and the last one is variable 0."""
    n = 300_000
    starts = np.append(np.arange(n), n - 1)
    chain = NATIVE.Csr(n, n, starts, np.arange(1, n), np.ones(n - 1))
    variable = np.full(n, -1)
    variable[-1] = 0
    resolved = chain.resolved(variable, 1)
    assert resolved.entries == n


def test_definitions_that_go_round_are_refused() -> None:
    ring = NATIVE.Csr(3, 3, np.arange(4), np.array([1, 2, 0]), np.ones(3))
    with pytest.raises(ValueError, match="circle"):
        ring.resolved(np.full(3, -1), 1)
