"""Splines in B-spline form: the interpolating one of odd degree, and the cubic through values and slopes.

Source: de Boor, A Practical Guide to Splines (2001), chapters IX to XIII. SciPy's splines give the same values, but
importing them takes longer than making the guess of a walk.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass


@dataclass(frozen=True, eq=False)
class Spline:
    """The curve sum_i c_i B_i(x) of B-splines of one degree.

    Attributes
    ----------
    knots : ndarray (n + degree + 1,)
        Ascending; the first and the last ``degree`` + 1 are the ends.
    coefficients : ndarray (n, ...)
        c_i.
    degree : int
    """

    knots: Array
    coefficients: Array
    degree: int

    def __call__(self, x: ArrayLike, order: int = 0) -> Array:
        """Return values, or derivatives of an order, at x (...) inside the ends, of the shape of x and then of c_i."""
        if order:
            return self.derivative(order)(x)
        at = np.asarray(x, dtype=float)
        span, values = _basis(self.knots, self.degree, at.ravel())
        near = self.coefficients[span[:, None] + np.arange(-self.degree, 1)]
        found = np.einsum("mi,mi...->m...", values, near)
        return np.asarray(found.reshape(at.shape + self.coefficients.shape[1:]))

    def derivative(self, order: int = 1) -> Spline:
        """Return the derivative of an order, at most the degree, as a spline."""
        if order == 0:
            return self
        k, t, c = self.degree, self.knots, self.coefficients
        widths = t[k + 1 : -1] - t[1 : -k - 1]
        slopes = k * np.diff(c, axis=0) / widths.reshape(-1, *[1] * (c.ndim - 1))
        return Spline(t[1:-1], slopes, k - 1).derivative(order - 1)


def through(x: Array, y: Array, degree: int) -> Spline:
    """Interpolate y (n, ...) at ascending x (n,) by an odd degree below n, without knots next to the ends.

    The knots are x without the (degree + 1) / 2 - 1 places next to each end.
    """
    aside = (degree + 1) // 2
    ends = np.ones(degree + 1)
    knots = np.concatenate([x[0] * ends, x[aside:-aside], x[-1] * ends])
    matrix = design_matrix(knots, degree, x)
    coefficients = np.asarray(np.linalg.solve(matrix, y.reshape(len(x), -1)), dtype=float)
    return Spline(knots, coefficients.reshape(y.shape), degree)


def design_matrix(knots: Array, degree: int, x: Array) -> Array:
    """Return B_i(x_j) (m, n) of the n B-splines of a degree at x (m,)."""
    span, values = _basis(knots, degree, x)
    matrix = np.zeros((len(x), len(knots) - degree - 1))
    matrix[np.arange(len(x))[:, None], span[:, None] + np.arange(-degree, 1)] = values
    return matrix


def hermite(x: Array, y: Array, slopes: Array) -> Spline:
    """Return the piecewise cubic with values y (n,) and slopes (n,) at ascending x (n,)."""
    third = np.diff(x) / 3.0
    inner = np.column_stack([y[:-1] + third * slopes[:-1], y[1:] - third * slopes[1:]]).ravel()
    knots = np.concatenate([x[[0, 0]], np.repeat(x, 2), x[[-1, -1]]])
    return Spline(knots, np.concatenate([y[:1], inner, y[-1:]]), 3)


def _basis(knots: Array, degree: int, x: Array) -> tuple[NDArray[np.int_], Array]:
    """Return the knot spans (m,) of x (m,) and the values (m, degree + 1) of the B-splines that are nonzero there."""
    last = len(knots) - degree - 2
    span = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, last)
    values = np.ones((len(x), 1))
    for k in range(1, degree + 1):
        first = span[:, None] + np.arange(1 - k, 1)
        left, right = knots[first], knots[first + k]
        shares = values / (right - left)
        nothing = np.zeros((len(x), 1))
        # Each B-spline of the lower degree contributes to its left and its right neighbour.
        values = np.hstack([(right - x[:, None]) * shares, nothing])
        values[:, 1:] += (x[:, None] - left) * shares
    return span, values
