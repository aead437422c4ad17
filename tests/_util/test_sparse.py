"""Sparse matrices have the methods and the values of SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse
from numpy.testing import assert_allclose, assert_array_equal

from robotraj._util.sparse import csr_array, diags_array, expand, vstack

SHAPES = [(1, 1, 1), (4, 3, 0), (5, 7, 12), (30, 20, 100), (50, 40, 900)]
"""Rows, columns and triplets; some triplets fall on one place."""


class Pair:
    """One matrix twice: ours and SciPy's."""

    def __init__(self, rows: int, columns: int, count: int, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        triplets = (
            rng.standard_normal(count),
            (rng.integers(0, rows, count), rng.integers(0, columns, count)),
        )
        self.ours = csr_array(triplets, (rows, columns))
        self.theirs = scipy.sparse.csr_array(triplets, shape=(rows, columns))


def same(ours: csr_array, theirs: scipy.sparse.csr_array) -> None:
    assert ours.shape == theirs.shape
    assert ours.nnz == theirs.nnz
    assert_allclose(ours.toarray(), theirs.toarray(), rtol=1e-13, atol=1e-13)
    keys = ours.row * ours.shape[1] + ours.col
    assert np.all(np.diff(keys) > 0)
    assert_array_equal(np.repeat(np.arange(ours.shape[0]), np.diff(ours.indptr)), ours.row)


@pytest.mark.parametrize("shape", SHAPES)
def test_triplets_of_one_place_add_up(shape: tuple[int, int, int]) -> None:
    pair = Pair(*shape)
    same(pair.ours, pair.theirs)
    same(csr_array(pair.ours.tocsc()), pair.theirs)
    assert_array_equal(pair.ours.tocsc().indptr, pair.theirs.tocsc().indptr)
    assert_array_equal(pair.ours.scipy().toarray(), pair.ours.toarray())


@pytest.mark.parametrize("shape", SHAPES)
def test_products(shape: tuple[int, int, int]) -> None:
    rows, columns, count = shape
    a, b = Pair(*shape), Pair(columns, 9, count, seed=1)
    right, left = np.random.default_rng(2).standard_normal(columns), np.random.default_rng(3).standard_normal(rows)
    same(a.ours @ b.ours, a.theirs @ b.theirs)
    assert_allclose(a.ours @ right, a.theirs @ right, rtol=1e-13, atol=1e-13)
    assert_allclose(left @ a.ours, left @ a.theirs, rtol=1e-13, atol=1e-13)
    assert_allclose(a.ours.T @ left, a.theirs.T @ left, rtol=1e-13, atol=1e-13)
    same(
        diags_array(left) @ a.ours @ diags_array(right),
        scipy.sparse.csr_array(scipy.sparse.diags_array(left) @ a.theirs @ scipy.sparse.diags_array(right)),
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_sums_leave_out_what_cancels(shape: tuple[int, int, int]) -> None:
    a, b = Pair(*shape), Pair(*shape, seed=1)
    same(a.ours + b.ours, a.theirs + b.theirs)
    same(a.ours - b.ours, a.theirs - b.theirs)
    assert (a.ours - a.ours).nnz == 0


@pytest.mark.parametrize("shape", SHAPES)
def test_rows_and_columns_are_taken_in_any_order(shape: tuple[int, int, int]) -> None:
    rows, columns, _ = shape
    pair = Pair(*shape)
    rng = np.random.default_rng(4)
    which, mask, taken = rng.integers(0, rows, 6), rng.random(rows) > 0.5, rng.integers(0, columns, 4)
    same(pair.ours[which], pair.theirs[which])
    same(pair.ours[mask], pair.theirs[mask])
    same(csr_array(pair.ours.tocsc()[:, taken]), scipy.sparse.csr_array(pair.theirs.tocsc()[:, taken]))
    same(vstack([pair.ours, pair.ours[which]]), scipy.sparse.vstack([pair.theirs, pair.theirs[which]]).tocsr())
    with pytest.raises(ValueError, match="whole columns"):
        pair.ours.tocsc()[1:, taken]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_copy_grows_alone(shape: tuple[int, int, int]) -> None:
    rows, columns, _ = shape
    pair = Pair(*shape)
    assert pair.ours.row.size == pair.ours.nnz
    grown, theirs = pair.ours.copy(), pair.theirs.copy()
    grown.resize((rows + 2, columns + 3))
    theirs.resize((rows + 2, columns + 3))
    same(grown, theirs)
    assert pair.ours.shape == (rows, columns)
    with pytest.raises(ValueError, match="can only grow"):
        grown.resize((rows, columns))


def test_empty_matrices_and_refused_sums() -> None:
    assert csr_array((3, 2)).nnz == 0
    assert_array_equal(csr_array((3, 2)) @ np.ones(2), np.zeros(3))
    with pytest.raises(ValueError, match="cannot be added"):
        csr_array((3, 2)) + csr_array((2, 3))


def test_expansion_records_the_source_of_entries() -> None:
    matrix = Pair(6, 5, 12).ours
    which = np.array([3, 0, 3, 5])
    indices, data, position = expand(matrix, which)
    dense = np.zeros((4, 5))
    dense[position, indices] = data
    assert_array_equal(dense, matrix.toarray()[which])
