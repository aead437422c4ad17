"""Sparse symmetric factors against dense linear algebra, for every kind of processor."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from robotraj._util.arrays import Array
from robotraj.native.build import load_native

NATIVE: Any = load_native()
PROCESSORS = NATIVE.processors()


def factors(matrix: Any, processor: str = "") -> tuple[Any, Array]:
    """The factors' object for a symmetric matrix, and the values of its lower triangle."""
    lower = sp.csc_matrix(sp.tril(matrix))
    lower.sort_indices()
    made = NATIVE.SymmetricFactors(lower.indptr.astype(np.int64), lower.indices.astype(np.int64), processor)
    return made, lower.data


def saddle_point(variables: int, constraints: int, density: float, seed: int) -> Array:
    """[[H, A'], [A, 0]], H indefinite, A of full rank."""
    rng = np.random.default_rng(seed)
    h = sp.random(variables, variables, density, random_state=rng, data_rvs=rng.standard_normal).toarray()
    a = sp.random(constraints, variables, density, random_state=rng, data_rvs=rng.standard_normal).toarray()
    a[np.arange(constraints), rng.permutation(variables)[:constraints]] += 3.0
    return np.block([[h + h.T + np.diag(rng.standard_normal(variables)), a.T], [a, np.zeros((constraints,) * 2)]])


def chain(stages: int, states: int, controls: int, seed: int) -> sp.csc_matrix:
    """Newton's system of an optimal control problem: x_{k+1} = A x_k + B u_k, with barriers of many sizes."""
    rng = np.random.default_rng(seed)
    size = states + controls
    weights = 10.0 ** rng.uniform(-6, 6, stages * size)
    rows = [
        sp.hstack(
            [
                sp.csr_matrix((states, k * size)),
                sp.csr_matrix(rng.standard_normal((states, size)) * (rng.random((states, size)) < 0.6)),
                -sp.eye(states),
                sp.csr_matrix((states, (stages - k - 1) * size - states)),
            ]
        )
        for k in range(stages - 1)
    ]
    a = sp.vstack(rows)
    return sp.csc_matrix(sp.bmat([[sp.diags(weights), a.T], [a, None]]))


def check(matrix: Any, processor: str, threshold: float = 1e-8) -> int:
    """Solve, compare with dense algebra, and give the number of delays."""
    dense = matrix.toarray() if sp.issparse(matrix) else matrix
    made, values = factors(matrix, processor)
    negative, zero, delayed = made.factorise(values, threshold)
    assert (negative, zero) == (np.sum(np.linalg.eigvalsh(dense) < 0), 0)
    b = np.random.default_rng(1).standard_normal(len(dense))
    x = made.solve(b)
    # Once refined, as IPOPT does.
    x += made.solve(b - dense @ x)
    size = np.abs(dense).sum(axis=1).max()
    assert np.abs(b - dense @ x).max() < 1e-11 * (size * np.abs(x).max() + 1.0)
    return int(delayed)


@pytest.mark.parametrize("processor", PROCESSORS)
@pytest.mark.parametrize(
    ("variables", "constraints", "density"),
    [(1, 0, 1.0), (1, 1, 1.0), (9, 4, 0.4), (40, 25, 0.1), (60, 60, 0.3), (150, 100, 0.03), (130, 40, 1.0)],
)
def test_a_saddle_point_is_solved_and_its_signs_counted(
    processor: str, variables: int, constraints: int, density: float
) -> None:
    check(saddle_point(variables, constraints, density, seed=3), processor)


@pytest.mark.parametrize("processor", PROCESSORS)
@pytest.mark.parametrize(("stages", "states", "controls"), [(2, 1, 1), (30, 6, 3), (12, 37, 24)])
def test_a_chain_of_stages(processor: str, stages: int, states: int, controls: int) -> None:
    made, values = factors(chain(stages, states, controls, seed=0), processor)
    negative, zero, _ = made.factorise(values)
    # One negative pivot a constraint, since what the constraints leave free has positive weights.
    assert (negative, zero) == ((stages - 1) * states, 0)
    # Fronts are of a few stages, not of the whole of a long chain.
    assert made.largest_front <= 6 * (states + controls)


@given(
    n=st.integers(1, 60),
    seed=st.integers(0, 2**31),
    density=st.floats(0.02, 1.0),
    weighed=st.sampled_from([0.0, 0.2, 1.0]),
    threshold=st.sampled_from([1e-8, 0.01, 0.5]),
)
@settings(max_examples=400, deadline=None)
def test_any_regular_matrix_is_factorised(n: int, seed: int, density: float, weighed: float, threshold: float) -> None:
    rng = np.random.default_rng(seed)
    upper = rng.standard_normal((n, n)) * (rng.random((n, n)) < density)
    # Many diagonals are zero, as those of constraints and of variables without weight are.
    upper[np.diag_indices(n)] = rng.standard_normal(n) * (rng.random(n) < weighed)
    matrix = np.triu(upper) + np.triu(upper, 1).T
    sizes = np.abs(np.linalg.eigvalsh(matrix))
    if sizes.min() < 1e-6 * sizes.max() or sizes.max() == 0:
        return
    check(matrix, "", threshold)


@pytest.mark.parametrize("processor", PROCESSORS)
def test_pivots_of_two_rows(processor: str) -> None:
    n = 20
    matrix = sp.bmat([[None, sp.eye(n)], [sp.eye(n), None]]).tocsc()
    made, values = factors(matrix, processor)
    assert made.factorise(values)[:2] == (n, 0)
    b = np.arange(2.0 * n)
    np.testing.assert_allclose(made.solve(b), np.roll(b, n), atol=1e-14)


def test_constraints_wait_for_their_variables() -> None:
    """Leaves of the tree that are constraints alone have no pivots: they are delayed, and nothing is lost."""
    # Each variable without weight is in two constraints; an arrow of weights joins them.
    n = 60
    a = sp.diags([1.0, 0.5], [0, 1], shape=(n, n + 1))
    weights = np.zeros(n + 1)
    weights[-1] = 2.0
    matrix = sp.bmat([[sp.diags(weights), a.T], [a, None]]).tocsc()
    assert check(matrix, "") > 0


def test_regularised_constraints_are_pivots_within_a_small_threshold() -> None:
    """They are not delayed; the inertia is right, and one refinement restores the digits of the solution."""
    matrix = saddle_point(150, 100, 0.03, seed=3)
    matrix[range(150, 250), range(150, 250)] = -1e-8
    made, values = factors(matrix)
    inertia, delayed = (np.sum(np.linalg.eigvalsh(matrix) < 0), 0), made.factorise(values, 1e-6)[2]
    negative, zero, left = made.factorise(values, 1e-10)
    assert (negative, zero) == inertia
    assert left < 0.05 * delayed
    b = np.random.default_rng(0).standard_normal(250)
    x = made.solve(b)
    x += made.solve(b - matrix @ x)
    np.testing.assert_allclose(matrix @ x, b, atol=1e-9)


def test_dependent_constraints_are_zero_pivots() -> None:
    matrix = saddle_point(12, 5, 0.5, seed=2)
    twice = np.zeros((18, 18))
    twice[:17, :17] = matrix
    twice[17, :12] = twice[:12, 17] = matrix[16, :12]
    made, values = factors(twice)
    negative, zero, _ = made.factorise(values, 1e-8, 1e-13)
    assert zero == 1
    assert negative == np.sum(np.linalg.eigvalsh(matrix) < 0)
    # Entries without a pivot are zero in the solution: consistent rows are still satisfied.
    b = twice @ np.ones(18)
    np.testing.assert_allclose(twice @ made.solve(b), b, atol=1e-9)


def test_a_zero_matrix_has_only_zero_pivots() -> None:
    made, values = factors(sp.csc_matrix((np.zeros(3), np.arange(3), np.arange(4)), shape=(3, 3)))
    assert made.factorise(np.zeros(len(values)))[:2] == (0, len(values))


def test_other_values_in_the_same_pattern() -> None:
    """Memory is reused, without values of the previous factors."""
    first, second = (saddle_point(50, 30, 0.2, seed) for seed in (0, 0))
    second = np.where(second != 0, second * np.random.default_rng(9).uniform(0.5, 2.0), 0.0)
    second[np.diag_indices(50)] *= -7.0
    made, values = factors(first)
    other = sp.csc_matrix(sp.tril(second)).data
    b = np.random.default_rng(0).standard_normal(80)
    made.factorise(values)
    kept = made.solve(b)
    made.factorise(other)
    np.testing.assert_allclose(second @ made.solve(b), b, atol=1e-9)
    made.factorise(values)
    np.testing.assert_array_equal(made.solve(b), kept)


def test_scales_far_apart_change_neither_inertia_nor_solution() -> None:
    matrix = saddle_point(30, 15, 0.3, seed=5)
    scale = 10.0 ** np.random.default_rng(0).uniform(-8, 8, 45)
    made, values = factors(scale[:, None] * matrix * scale)
    negative, zero, _ = made.factorise(values)
    assert (negative, zero) == (np.sum(np.linalg.eigvalsh(matrix) < 0), 0)
    x = np.random.default_rng(1).standard_normal(45)
    np.testing.assert_allclose(made.solve(scale * (matrix @ x)) * scale, x, atol=1e-9)


def test_entries_above_the_diagonal_are_refused() -> None:
    with pytest.raises(ValueError, match="lower triangle"):
        NATIVE.SymmetricFactors(np.array([0, 1, 3]), np.array([0, 0, 1]))
    with pytest.raises(ValueError, match="values has 2 entries, expected 3"):
        NATIVE.SymmetricFactors(np.array([0, 2, 3]), np.array([0, 1, 1])).factorise(np.ones(2))
