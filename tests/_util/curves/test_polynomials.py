"""Quadrature on Legendre's points equals NumPy's to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from robotraj._util.curves.polynomials import gauss, integrals


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 12, 30])
def test_points_and_weights_are_numpys(count: int) -> None:
    for found, known in zip(gauss(count), np.polynomial.legendre.leggauss(count), strict=True):
        # NumPy's own differ in the last digits from release to release.
        np.testing.assert_allclose(found, known, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("count", [2, 3, 5, 8])
def test_integrals_are_exact_for_the_degree(count: int) -> None:
    sites, tau = np.linspace(0.0, 1.0, count), np.array([0.3, 1.0])
    powers = np.arange(count)
    values = integrals(sites, tau) @ sites[:, None] ** powers
    np.testing.assert_allclose(values, tau[:, None] ** (powers + 1) / (powers + 1), rtol=1e-12)
