"""Lagrange polynomials on given sites of [0, 1]: evaluation, differentiation and integration.

Barycentric formulas keep high orders stable; integrals use Gauss-Legendre quadrature that is exact for the degree.
Source: Berrut and Trefethen, Barycentric Lagrange Interpolation, SIAM Review 46 (2004).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array


@lru_cache(maxsize=256)
def _weights(sites: tuple[float, ...]) -> Array:
    nodes = np.array(sites)
    gaps = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(gaps, 1.0)
    # Products of gaps underflow at high order; only ratios of the weights matter.
    logs = np.log(np.abs(gaps)).sum(axis=1)
    signs = np.prod(np.sign(gaps), axis=1)
    weights = signs * np.exp(logs.min() - logs)
    weights.setflags(write=False)
    return weights


_FEW = {1: (np.zeros(1), np.array([2.0])), 2: (np.sqrt(1 / 3) * np.array([-1.0, 1.0]), np.ones(2))}
"""Gauss-Legendre quadrature of least order, which most schemes need: points and weights."""


@lru_cache(maxsize=256)
def gauss(count: int) -> tuple[Array, Array]:
    """Points and weights of Gauss-Legendre quadrature on [-1, 1], as NumPy's ``leggauss`` without its import.

    The points are eigenvalues of the Jacobi matrix (Golub and Welsch, Mathematics of Computation 23, 1969), improved
    by one Newton step and made symmetric.
    """
    if count in _FEW:
        return _FEW[count]
    k = np.arange(1, count)
    scale = 1.0 / np.sqrt(2 * np.arange(count) + 1)
    beside = k * scale[:-1] * scale[1:]
    points = np.asarray(np.linalg.eigvalsh(np.diag(beside, 1) + np.diag(beside, -1)), dtype=float)
    legendre = np.append(np.zeros(count), 1.0)
    rate = np.zeros(count)
    rate[count - 1 :: -2] = 2 * np.arange(count - 1, -1, -2) + 1
    slope = legendre_sum(points, rate)
    points = points - legendre_sum(points, legendre) / slope
    below = legendre_sum(points, legendre[1:])
    weights = 1.0 / (below / np.abs(below).max() * (slope / np.abs(slope).max()))
    points, weights = (points - points[::-1]) / 2.0, (weights + weights[::-1]) / 2.0
    weights *= 2.0 / weights.sum()
    points.setflags(write=False)
    weights.setflags(write=False)
    return points, weights


def legendre_sum(x: Array, c: Array) -> Array:
    """Sum of c_k P_k(x), by Clenshaw's recurrence."""
    if len(c) == 1:
        return np.full_like(x, c[0])
    before, last = c[-2] + 0.0 * x, c[-1] + 0.0 * x
    for i in range(3, len(c) + 1):
        n = len(c) - i + 2
        before, last = c[-i] - last * ((n - 1) / n), before + last * x * ((2 * n - 1) / n)
    return before + last * x


def basis(sites: Array, tau: Array) -> Array:
    """Values of the Lagrange polynomials: l_k(tau_i), shape (len(tau), len(sites))."""
    sites = np.asarray(sites, dtype=float)
    tau = np.atleast_1d(np.asarray(tau, dtype=float))
    weights = _weights(tuple(sites.tolist()))
    gaps = tau[:, None] - sites[None, :]
    hit = gaps == 0.0
    rows = hit.any(axis=1)
    gaps[rows] = 1.0
    terms = weights / gaps
    terms[rows] = hit[rows]
    return np.asarray(terms / terms.sum(axis=1, keepdims=True))


def basis_at(sites: Array, tau: float) -> Array:
    """Values of the Lagrange polynomials at one tau, (len(sites),); faster than ``basis``."""
    gaps = tau - sites
    hit = gaps == 0.0
    if hit.any():
        return hit.astype(float)
    terms = _weights(tuple(sites.tolist())) / gaps
    return np.asarray(terms / terms.sum())


def differentiation(sites: Array) -> Array:
    """Matrix D with (D y)_i = p'(sites_i) for the polynomial p through (sites, y)."""
    sites = np.asarray(sites, dtype=float)
    weights = _weights(tuple(sites.tolist()))
    gaps = sites[:, None] - sites[None, :]
    np.fill_diagonal(gaps, 1.0)
    matrix = weights[None, :] / weights[:, None] / gaps
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def integrals(sites: Array, tau: Array) -> Array:
    """Integrals of the Lagrange polynomials from 0 to tau_i, shape (len(tau), len(sites))."""
    sites = np.asarray(sites, dtype=float)
    tau = np.atleast_1d(np.asarray(tau, dtype=float))
    points, weights = gauss(len(sites) // 2 + 1)
    half = 0.5 * tau
    inner = half[:, None] * (points[None, :] + 1.0)
    values = basis(sites, inner.ravel()).reshape(len(tau), len(points), len(sites))
    return half[:, None] * np.einsum("m,imk->ik", weights, values)


def lobatto_sites(count: int) -> Array:
    """Chebyshev-Lobatto points of [0, 1], ascending: good sites to store a polynomial by its values."""
    if count == 1:
        return np.array([0.5])
    return 0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1)))
