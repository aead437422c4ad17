"""Smooth paths near given ones, for motions of bounded jerk.

The accelerations of a plan jump where its torques switch. A motion of bounded jerk along such a path must stop there.
Along a path with continuous curvature near it, no stop is needed.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.splines import Spline, design_matrix
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError

DEGREE = 5
"""Degree of the spline: its fourth derivative is continuous."""
FEWEST, MOST = 16, 512
"""Numbers of pieces with which the search for knots begins and ends."""
SHARE = 0.5
"""Share of the deviation that the spline may take up before it is smoothed."""
LEAST, LARGEST, HALVINGS = -24.0, 6.0, 20
"""Range of the decimal logarithm of the weight of the third derivative, and number of its bisections."""
ROUNDS, AIM, GROWTH, SPREAD = 12, 0.85, 3.0, 1e5
"""Changes of the weights of samples: their number, the share of the deviation that they aim at, and their bounds."""
SAMPLES = 12
"""Number of samples of a piece of the given path, and of one of the spline."""
MOVING = 1e-6
"""Least slope at an end at which the joints move there, relative to the largest."""
STILL = 1e-9
"""Largest step between two samples at which the joints rest, relative to the length of the path."""


def smoothed(path: PiecewisePolynomial, deviation: float, lower: Array, upper: Array) -> PiecewisePolynomial:
    """Return a path with a continuous fourth derivative near a given one.

    Its parameter s is the length of the given path [rad, m]. It is a spline f of degree 5 with a small int |f'''|^2 ds
    among those with |f_j - p_j| <= deviation for every joint j. It has the ends of p. Where p moves at an end, it has
    the direction of p there. Pieces are halved where the spline nearest to p is not within half of the deviation.
    Then f minimises sum_i w_i |f - p|^2 + int |f'''|^2 ds, where the weights of samples grow with their distances.
    The coefficients are within the limits of position, and so is f.

    Parameters
    ----------
    path : PiecewisePolynomial
        p, from any parameter to q (n,) [rad, m].
    deviation : float
        Largest distance of a joint between f and p at equal lengths [rad, m].
    lower, upper : ndarray (n,)
        Limits of position.

    Raises
    ------
    InputError
        No spline of 512 pieces is within the deviation.

    Notes
    -----
    Source of the weights: Lawson, Contributions to the theory of linear least maximum approximation (1961).
    """
    fit = _Fit(path, np.linspace(0.0, 1.0, FEWEST + 1), lower, upper)
    while (far := fit.of_pieces(fit.distances(fit.nearest)) > SHARE * deviation).any():
        if len(far) + far.sum() > MOST:
            raise InputError(
                f"No spline of {MOST} pieces stays within deviation={deviation:g} of the path. "
                "Give a larger deviation=, or 0 for the path as it is."
            )
        shares = fit.breaks / fit.breaks[-1]
        middles = 0.5 * (shares[:-1] + shares[1:])
        fit = _Fit(path, np.sort(np.concatenate([shares, middles[far]])), lower, upper)
    return fit.curve(fit.smoothest(deviation))


class _Samples:
    """A path as points over its length, without its rests."""

    def __init__(self, path: PiecewisePolynomial, shares: Array) -> None:
        """Sample the pieces of the path, and those between shares of its length."""
        at = _within(path.breaks, SAMPLES)
        points, places = self._measured(path, at)
        wanted = _within(shares * places[-1], SAMPLES)
        points, places = self._measured(path, np.union1d(at, np.interp(wanted, places, at)))
        moves = np.append(True, np.diff(places) > STILL * places[-1])
        self.points, self.places = points[moves], places[moves]
        self.ends, self.length = points[[0, -1]], float(self.places[-1])
        slopes = path.derivative()
        largest = max(float(np.abs(values).max()) for values in slopes.values)
        ends = [slopes(path.breaks[end]) for end in (0, -1)]
        self.directions = [
            slope / np.linalg.norm(slope) if np.abs(slope).max() > MOVING * largest else None for slope in ends
        ]

    @staticmethod
    def _measured(path: PiecewisePolynomial, at: Array) -> tuple[Array, Array]:
        points = path(at)
        return points, np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))


def _within(breaks: Array, count: int) -> Array:
    """Return ascending places: the breaks, and equal steps between them."""
    inside = breaks[:-1, None] + np.diff(breaks)[:, None] * np.linspace(0.0, 1.0, count, endpoint=False)
    return np.append(inside.ravel(), breaks[-1])


class _Fit:
    """Splines with given breaks near the samples, for any weights."""

    def __init__(self, path: PiecewisePolynomial, shares: Array, lower: Array, upper: Array) -> None:
        self.data = data = _Samples(path, shares)
        self.breaks = breaks = shares * data.length
        self.lower, self.upper = lower, upper
        ends, lengths = np.ones(DEGREE), np.diff(breaks)
        self.knots = np.concatenate([breaks[0] * ends, breaks, breaks[-1] * ends])
        self.matrix = design_matrix(self.knots, DEGREE, data.places)
        self.shares = np.gradient(data.places) / data.length
        count = self.matrix.shape[1]
        third = Spline(self.knots, np.eye(count), DEGREE).derivative(3)
        nodes, weights = np.polynomial.legendre.leggauss(3)
        at = breaks[:-1, None] + lengths[:, None] * (0.5 + 0.5 * nodes)
        rows = third(at.ravel()) * np.sqrt(np.outer(lengths, 0.5 * weights).ravel())[:, None]
        self.bending = rows.T @ rows
        self.known = np.zeros((count, data.points.shape[1]))
        self.free = np.ones(count, dtype=bool)
        for end, sign, length in ((0, 1, lengths[0]), (-1, -1, lengths[-1])):
            self.known[end], self.free[end] = data.ends[end], False
            direction = data.directions[end]
            if direction is not None:
                self.known[end + sign] = data.ends[end] + sign * direction * length / DEGREE
                self.free[end + sign] = False

    @property
    def nearest(self) -> Array:
        """Coefficients of the spline nearest to the samples."""
        return self.coefficients(10.0**LEAST, self.shares)

    def coefficients(self, bending: float, weights: Array) -> Array:
        """Return the coefficients for a weight of the third derivative and weights of the samples (m,)."""
        weighed = weights[:, None] * self.matrix
        matrix = self.matrix.T @ weighed + bending * self.bending
        right = weighed.T @ self.data.points - matrix @ self.known
        found = self.known.copy()
        found[self.free] = np.linalg.solve(matrix[np.ix_(self.free, self.free)], right[self.free])
        found[self.free] = np.clip(found[self.free], self.lower, self.upper)
        return found

    def distances(self, coefficients: Array) -> Array:
        """Return the largest distance of a joint from every sample (m,)."""
        return np.asarray(np.abs(self.matrix @ coefficients - self.data.points).max(axis=1))

    def of_pieces(self, distances: Array) -> Array:
        """Return the largest distance in every piece."""
        piece = np.clip(np.searchsorted(self.breaks, self.data.places, side="right") - 1, 0, len(self.breaks) - 2)
        found = np.zeros(len(self.breaks) - 1)
        np.maximum.at(found, piece, distances)
        return found

    def smoothest(self, deviation: float) -> Array:
        """Return the coefficients with the smallest third derivative that were found within the deviation."""
        low, high = LEAST, LARGEST
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            near = self.distances(self.coefficients(10.0**middle, self.shares)).max() <= deviation
            low, high = (middle, high) if near else (low, middle)
        best = self.coefficients(10.0**low, self.shares)
        factors = np.ones(len(self.shares))
        for _ in range(ROUNDS):
            found = self.coefficients(10.0**low, factors * self.shares)
            distances = self.distances(found) / deviation
            if distances.max() <= 1.0 and self._roughness(found) < self._roughness(best):
                best = found
            factors *= np.clip(distances / AIM, 1.0 / GROWTH, GROWTH)
            factors = np.clip(factors, 1.0 / SPREAD, SPREAD)
        return best

    def _roughness(self, coefficients: Array) -> float:
        return float(np.einsum("in,ij,jn->", coefficients, self.bending, coefficients))

    def curve(self, coefficients: Array) -> PiecewisePolynomial:
        """Return a spline as a path."""
        spline, sites = Spline(self.knots, coefficients, DEGREE), np.linspace(0.0, 1.0, DEGREE + 1)
        values = spline(self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * sites)
        return PiecewisePolynomial(self.breaks, [sites] * len(values), list(values))
