"""Polynomials on Lagrange sites, and piecewise polynomials in time."""

from __future__ import annotations

import numpy as np
import pytest

from robotraj._util.curves.polynomials import basis, differentiation, integrals, lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial

SITES = [np.array([0.5]), np.array([0.0, 1.0]), np.array([0.1, 0.4, 0.9]), lobatto_sites(12)]


@pytest.mark.parametrize("sites", SITES, ids=len)
def test_basis_reproduces_every_polynomial_of_its_degree(sites: np.ndarray) -> None:
    tau = np.concatenate([np.linspace(-0.1, 1.1, 13), sites])
    for power in range(len(sites)):
        np.testing.assert_allclose(basis(sites, tau) @ sites**power, tau**power, atol=1e-11)


@pytest.mark.parametrize("sites", SITES, ids=len)
def test_differentiation_and_integrals_are_exact(sites: np.ndarray) -> None:
    tau = np.linspace(0, 1, 9)
    for power in range(len(sites)):
        slope = power * sites ** max(power - 1, 0)
        np.testing.assert_allclose(differentiation(sites) @ sites**power, slope, atol=1e-11)
        np.testing.assert_allclose(integrals(sites, tau) @ sites**power, tau ** (power + 1) / (power + 1), atol=1e-14)


def cubic_then_line() -> PiecewisePolynomial:
    """t^3 - t on [1, 3], then a constant 5 on [3, 4], both beside their negatives."""
    sites = [lobatto_sites(4), np.array([0.0, 1.0])]
    t = 1 + 2 * sites[0]
    first = np.column_stack([t**3 - t, t - t**3])
    return PiecewisePolynomial(np.array([1.0, 3.0, 4.0]), sites, [first, np.array([[5.0, -5.0], [5.0, -5.0]])])


def test_a_time_gives_a_vector_and_times_give_a_matrix() -> None:
    curve = cubic_then_line()
    assert curve.size == 2
    assert curve(2.0).shape == (2,) and curve([2.0, 3.5, 1.0]).shape == (3, 2)
    np.testing.assert_allclose(curve([2.0, 3.5, 1.0])[:, 0], [6, 5, 0], atol=1e-13)


def test_a_knot_belongs_to_its_right_unless_the_interval_is_given() -> None:
    curve = cubic_then_line()
    assert curve(3.0)[0] == 5.0
    assert curve(3.0, interval=0)[0] == pytest.approx(24.0, abs=1e-12)
    assert curve(4.0)[0] == 5.0


def test_the_derivative_is_that_of_each_piece() -> None:
    rate = cubic_then_line().derivative()
    t = np.linspace(1, 2.99, 7)
    np.testing.assert_allclose(rate(t)[:, 0], 3 * t**2 - 1, atol=1e-11)
    np.testing.assert_allclose(rate([3.2, 4.0]), 0, atol=1e-12)


def test_shifting_moves_time_alone() -> None:
    curve = cubic_then_line()
    t = np.linspace(1, 4, 11)
    np.testing.assert_allclose(curve.shifted(2.5)(t + 2.5), curve(t), atol=1e-12)


def test_the_rest_of_a_curve_is_the_same_polynomial():
    breaks, sites = np.array([0.0, 1.0, 3.0]), np.linspace(0.0, 1.0, 4)
    ends = zip(breaks, breaks[1:], strict=False)
    curve = PiecewisePolynomial(breaks, [sites, sites], [((a + (b - a) * sites) ** 3)[:, None] for a, b in ends])
    for start in (0.0, 0.4, 1.0, 2.5):
        t = np.linspace(start, 3.0, 31)
        assert np.allclose(curve.after(start)(t)[:, 0], t**3) and curve.after(start).breaks[0] == start
    with pytest.raises(ValueError, match="not before the end"):
        curve.after(3.0)
