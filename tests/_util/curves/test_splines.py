"""Splines interpolate the given points, are smooth, and equal SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from robotraj._util.curves.splines import hermite, through

X = np.array([0.0, 0.1, 0.25, 0.3, 0.5, 0.55, 0.7, 0.8, 1.0])
FINE = np.linspace(0.0, 1.0, 83)


@pytest.mark.parametrize("degree", [1, 3, 5])
def test_an_interpolating_spline_is_scipys(degree: int) -> None:
    y = np.random.default_rng(0).normal(size=(len(X), 3))
    ours, theirs = through(X, y, degree), scipy.interpolate.make_interp_spline(X, y, k=degree)
    np.testing.assert_allclose(ours(X), y, atol=1e-12)
    for order in range(degree):
        size = np.abs(theirs(FINE, order)).max()
        np.testing.assert_allclose(ours(FINE, order), theirs(FINE, order), atol=1e-11 * size)


@pytest.mark.parametrize("degree", [3, 5])
def test_polynomials_of_its_degree_are_met_with_their_derivatives(degree: int) -> None:
    line = np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0, -0.7, 1.1][: degree + 1])
    curve = through(X, line(X), degree)
    for order in range(degree):
        np.testing.assert_allclose(curve(FINE, order), line.deriv(order)(FINE) if order else line(FINE), atol=1e-8)


def test_a_hermite_cubic_has_its_values_and_slopes() -> None:
    random = np.random.default_rng(1)
    y, slopes = random.normal(size=len(X)), random.normal(size=len(X))
    ours, theirs = hermite(X, y, slopes), scipy.interpolate.CubicHermiteSpline(X, y, slopes)
    np.testing.assert_allclose(ours(X), y, atol=1e-13)
    np.testing.assert_allclose(ours(X, 1), slopes, atol=1e-12)
    np.testing.assert_allclose(ours(FINE), theirs(FINE), atol=1e-12)
    assert ours(0.5) == pytest.approx(y[4])
    assert np.shape(ours(0.5)) == ()
