"""Passes over slacks, bounds and multipliers against their formulas, for every kind of processor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from robotraj.native.build import load_native

Array = NDArray[np.float64]
NATIVE: Any = load_native()
# Shorter than a register, one of each kind, whole registers, and with a rest.
LENGTHS = [0, 1, 3, 8, 40, 1203]

pytestmark = [pytest.mark.parametrize("processor", NATIVE.processors()), pytest.mark.parametrize("n", LENGTHS)]


@dataclass
class Slacks:
    """Slacks between bounds, of which some have one and some none."""

    lower: Array
    upper: Array
    s: Array
    vectors: Any

    @property
    def has_lower(self) -> NDArray[np.bool_]:
        return np.isfinite(self.lower)

    @property
    def has_upper(self) -> NDArray[np.bool_]:
        return np.isfinite(self.upper)

    @property
    def below(self) -> Array:
        return np.where(self.has_lower, self.s - self.lower, 1.0)

    @property
    def above(self) -> Array:
        return np.where(self.has_upper, self.upper - self.s, 1.0)


def slacks(n: int, processor: str, seed: int = 0) -> tuple[Slacks, np.random.Generator]:
    rng = np.random.default_rng(seed)
    s = rng.standard_normal(n)
    lower = np.where(rng.random(n) < 0.7, s - 10.0 ** rng.uniform(-6, 3, n), -np.inf)
    upper = np.where(rng.random(n) < 0.7, s + 10.0 ** rng.uniform(-6, 3, n), np.inf)
    return Slacks(lower, upper, s, NATIVE.SlackVectors(lower, upper, processor)), rng


def duals(given: Slacks, rng: np.random.Generator) -> tuple[Array, Array]:
    size = len(given.s)
    lower, upper = (10.0 ** rng.uniform(-6, 3, size) for _ in range(2))
    return np.where(given.has_lower, lower, 0.0), np.where(given.has_upper, upper, 0.0)


def test_magnitudes_and_sums_equal_those_of_numpy(n: int, processor: str) -> None:
    given, rng = slacks(n, processor)
    x, y = rng.standard_normal(n), rng.standard_normal(n)
    largest, total, finite = given.vectors.measures(x)
    assert largest == np.abs(x).max(initial=0.0)
    assert total == pytest.approx(np.abs(x).sum(), rel=1e-13)
    assert finite
    np.testing.assert_array_equal(given.vectors.add(x, y), x + y)
    for broken in (np.nan, np.inf, -np.inf):
        for place in {0, n // 2, n - 1} if n else ():
            wrong = x.copy()
            wrong[place] = broken
            assert not given.vectors.measures(wrong)[2]


def test_distances_and_the_sum_of_their_logarithms(n: int, processor: str) -> None:
    given, _ = slacks(n, processor)
    below, above, logarithm, single = given.vectors.distances(given.s)
    np.testing.assert_array_equal(below, given.below)
    np.testing.assert_array_equal(above, given.above)
    expected = np.log(below).sum() + np.log(above).sum()
    assert logarithm == pytest.approx(expected, rel=1e-13, abs=1e-13)
    only = (below * (given.has_lower & ~given.has_upper)).sum() + (above * (given.has_upper & ~given.has_lower)).sum()
    assert single == pytest.approx(only, rel=1e-13)


@pytest.mark.parametrize("distance", [1e-300, 1e300, 5e-324, np.inf])
def test_the_sum_of_logarithms_neither_overflows_nor_vanishes(n: int, processor: str, distance: float) -> None:
    vectors = NATIVE.SlackVectors(np.full(n, -distance), np.full(n, np.inf), processor)
    if not np.isfinite(distance):
        vectors = NATIVE.SlackVectors(np.full(n, -1.0), np.full(n, np.inf), processor)
    logarithm = vectors.distances(np.full(n, 0.0 if np.isfinite(distance) else np.inf))[2]
    assert logarithm == pytest.approx(sum([np.log(distance)] * n), rel=1e-12)


def test_a_slack_beyond_its_bound_has_no_logarithm(n: int, processor: str) -> None:
    given, _ = slacks(n, processor)
    for place in {0, n - 1} if n else ():
        for s, expected in ((-1.0, np.nan), (0.0, -np.inf)):
            lower = np.where(np.arange(n) == place, 0.0, given.lower)
            moved = np.where(np.arange(n) == place, s, given.s)
            logarithm = NATIVE.SlackVectors(lower, np.full(n, np.inf), processor).distances(moved)[2]
            np.testing.assert_equal(logarithm, expected)


def test_slope_of_the_barrier(n: int, processor: str) -> None:
    given, rng = slacks(n, processor)
    mu, damping, ds = 0.03, 1e-5, rng.standard_normal(n)
    gradient, slope = given.vectors.barrier(given.below, given.above, mu, damping, ds)
    expected = np.where(given.has_upper, mu / given.above, 0.0) - np.where(given.has_lower, mu / given.below, 0.0)
    expected += damping * (given.has_lower & ~given.has_upper) - damping * (given.has_upper & ~given.has_lower)
    np.testing.assert_allclose(gradient, expected, rtol=1e-13)
    assert slope == pytest.approx(expected @ ds, rel=1e-10, abs=1e-12)


def test_complementarity(n: int, processor: str) -> None:
    given, rng = slacks(n, processor)
    (lower, upper), mu = duals(given, rng), 0.1
    of_lower, of_upper, largest = given.vectors.complementarity(given.below, given.above, lower, upper, mu)
    np.testing.assert_allclose(
        of_lower, np.where(given.has_lower, lower * given.below - mu, 0.0), rtol=1e-12, atol=1e-14
    )
    np.testing.assert_allclose(
        of_upper, np.where(given.has_upper, upper * given.above - mu, 0.0), rtol=1e-12, atol=1e-14
    )
    assert largest == np.abs(np.concatenate([of_lower, of_upper])).max(initial=0.0)


@pytest.mark.parametrize("scale", [1e-8, 1.0])
def test_steps_to_the_boundary(n: int, processor: str, scale: float) -> None:
    given, rng = slacks(n, processor)
    (lower, upper), tau = duals(given, rng), 0.99
    ds, dl, du = (scale * rng.standard_normal(n) for _ in range(3))
    length = given.vectors.longest_step(given.below, given.above, ds, tau)
    ratios = [tau * given.below[i] / -ds[i] for i in np.flatnonzero(given.has_lower & (ds < 0))]
    ratios += [tau * given.above[i] / ds[i] for i in np.flatnonzero(given.has_upper & (ds > 0))]
    assert length == pytest.approx(min([1.0, *ratios]), rel=1e-14)
    length = given.vectors.longest_dual_step(lower, dl, upper, du, tau)
    ratios = [tau * lower[i] / -dl[i] for i in np.flatnonzero(given.has_lower & (dl < 0))]
    ratios += [tau * upper[i] / -du[i] for i in np.flatnonzero(given.has_upper & (du < 0))]
    assert length == pytest.approx(min([1.0, *ratios]), rel=1e-14)


def test_multipliers_are_kept_near_the_central_path(n: int, processor: str) -> None:
    given, rng = slacks(n, processor)
    z, mu, kappa = 10.0 ** rng.uniform(-6, 3, n), 0.02, 10.0
    expected = np.clip(z, mu / (kappa * given.below), kappa * mu / given.below)
    found = given.vectors.clamped(given.below, z, mu, kappa)
    np.testing.assert_allclose(found, np.where(given.has_lower, expected, 0.0), rtol=1e-14)


def test_slacks_are_eliminated_and_found_again(n: int, processor: str) -> None:
    given, rng = slacks(n, processor)
    lower, upper = duals(given, rng)
    damping, relaxation = rng.uniform(0.1, 1.0, n), rng.random(n)
    f, cl, cu, g, products = (rng.standard_normal(n) for _ in range(5))
    system = np.concatenate([given.below, given.above, lower, upper, damping, relaxation])
    side = np.concatenate([f, cl, cu, g])
    inverse, gradient, weights, rows = given.vectors.eliminated(system, side)
    # Multipliers that solve A x - weights lam = -rows for A x = products.
    lam = (products + rows) / weights
    s, zl, zu = given.vectors.recovered(system, side, inverse, gradient, lam)
    terms = np.abs(lam) + np.abs(lower * s) / given.below + np.abs(upper * s) / given.above
    terms += np.abs(cl) / given.below + np.abs(cu) / given.above
    left = np.concatenate(
        [
            (damping * s - lam - zl + zu + f) / (1 + terms),
            (lower * s + given.below * zl + cl) / (1 + np.abs(lower * s)),
            (-upper * s + given.above * zu + cu) / (1 + np.abs(upper * s)),
            (products - s - relaxation * lam + g) / (1 + np.abs(s)),
        ]
    )
    assert np.abs(left).max(initial=0.0) < 1e-12


def test_what_is_left_of_the_slacks_equations(n: int, processor: str) -> None:
    given, rng = slacks(n, processor)
    system, side, step = (rng.standard_normal((rows, n)) for rows in (6, 4, 3))
    lam, rows = rng.standard_normal(n), rng.standard_normal(n)
    below, above, lower, upper, damping, relaxation = system
    (f, cl, cu, _), (s, zl, zu) = side, step
    left, changed, largest = given.vectors.residual(system.ravel(), side.ravel(), step.ravel(), lam, rows)
    expected = [f + damping * s - lam - zl + zu, cl + lower * s + below * zl, cu - upper * s + above * zu]
    np.testing.assert_allclose(left, np.concatenate(expected), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(changed, rows - s - relaxation * lam, rtol=1e-12, atol=1e-13)
    assert largest == np.abs(left).max(initial=0.0)
