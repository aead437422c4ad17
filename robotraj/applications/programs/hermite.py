"""Polynomials of degree five between two states with first and second derivatives."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array

SITES = np.linspace(0.0, 1.0, 6)
"""Places of the values of a polynomial in its interval."""
_POWERS = np.vander(SITES, increasing=True)
_ENDS = np.array([[1.0, 1.0, 1.0], [3.0, 4.0, 5.0], [6.0, 12.0, 20.0]])
"""Value and two derivatives at 1 of x^3, x^4 and x^5."""


def hermite(first: Array, last: Array, length: float) -> Array:
    """Return the values (6, n) at ``SITES`` of the polynomial with given ends.

    Where the second derivatives vanish, its Bezier points are p0, p0 + h p0', p0 + 2 h p0' and p1 - 2 h p1',
    p1 - h p1', p1 with h = length / 5. The curve lies in their convex hull.

    Parameters
    ----------
    first, last : ndarray (3, n)
        Value, first and second derivative at both ends.
    length : float
        Of the interval.
    """
    scale = length ** np.arange(3.0)[:, None]
    low = scale * first / np.array([[1.0], [1.0], [2.0]])
    ahead = np.array([low.sum(axis=0), low[1] + 2.0 * low[2], 2.0 * low[2]])
    return np.asarray(_POWERS @ np.concatenate([low, np.linalg.solve(_ENDS, scale * last - ahead)]))
