"""Measured ground: heights on a regular grid, interpolated by a bicubic spline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground

MIN_SAMPLES = 4
"""Smallest number of samples along a side: that of a cubic spline with not-a-knot ends."""


@dataclass(frozen=True, eq=False)
class HeightMap(Ground):
    """Heights on a regular grid, interpolated by the bicubic spline with not-a-knot ends.

    h(x, y) = sum_ij c_ij B_i(x) B_j(y) with cubic B-splines on the grid. Inside the grid h is twice differentiable and
    equals SciPy's ``RectBivariateSpline``. Outside it is extrapolated linearly with the slope at the edge. The number
    of multiplications of an evaluation equals the number of samples. Crop the map to the part that the robot crosses,
    and choose a spacing of the order of a foot's size. Source: de Boor, A Practical Guide to Splines (2001), chapters
    IV and XVII.

    Parameters
    ----------
    heights : (n, m) array_like
        ``heights[i, j]`` [m] at x = origin[0] + i spacing[0], y = origin[1] + j spacing[1]; n, m >= 4.
    spacing : (float, float)
        Distance between samples along x and y [m].
    origin : (float, float)
        World x and y of ``heights[0, 0]`` [m].

    Raises
    ------
    InputError
        Too few samples, a height that is not finite, a spacing that is not positive.
    """

    heights: Sequence[Sequence[float]] | Array = field(repr=False)
    spacing: tuple[float, float]
    origin: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        heights = np.array(self.heights, dtype=float)
        if heights.ndim != 2 or min(heights.shape) < MIN_SAMPLES:
            raise InputError(
                f"rt.terrain.HeightMap has heights of shape {heights.shape}; give (n, m) samples along x and y, "
                f"at least {MIN_SAMPLES} along each."
            )
        bad = np.argwhere(~np.isfinite(heights))
        if len(bad):
            i, j = (int(k) for k in bad[0])
            raise InputError(
                f"rt.terrain.HeightMap: heights[{i}, {j}] is {heights[i, j]}, one of {len(bad)} that are not "
                f"finite; replace them by finite heights."
            )
        heights.setflags(write=False)
        object.__setattr__(self, "heights", heights)
        for name in ("spacing", "origin"):
            pair = np.asarray(getattr(self, name), dtype=float).ravel()
            if pair.size != 2 or not np.isfinite(pair).all():
                raise InputError(
                    f"rt.terrain.HeightMap: {name} is {getattr(self, name)!r}; give two numbers [m], of x and y."
                )
            object.__setattr__(self, name, (float(pair[0]), float(pair[1])))
        if not min(self.spacing) > 0:
            raise InputError(f"rt.terrain.HeightMap: spacing is {self.spacing}; give positive distances [m].")

    @classmethod
    def from_array(cls, x: ArrayLike, y: ArrayLike, heights: ArrayLike) -> HeightMap:
        """Return the map with ``heights[i, j]`` [m] at (x[i], y[j]) [m]; x and y increase in equal steps.

        Raises
        ------
        InputError
            The lengths of x and y differ from the shape of the heights, or their steps are not equal and positive.
        """
        spacing, origin = [], []
        for name, values, count in zip("xy", (x, y), np.shape(heights), strict=False):
            places = np.asarray(values, dtype=float).ravel()
            steps = np.diff(places)
            if len(places) != count or count < 2:
                raise InputError(
                    f"rt.terrain.HeightMap: {len(places)} values of {name} for heights of {np.shape(heights)}; "
                    f"give {count}."
                )
            if not (steps.min() > 0 and np.ptp(steps) < 1e-6 * steps.mean()):
                raise InputError(
                    f"rt.terrain.HeightMap: {name} increases by {steps.min():g} to {steps.max():g} m a sample; "
                    "resample the heights onto even steps."
                )
            spacing.append((places[-1] - places[0]) / (count - 1))
            origin.append(places[0])
        return cls(np.asarray(heights, dtype=float), tuple(spacing), tuple(origin))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, HeightMap)
            and (self.spacing, self.origin) == (other.spacing, other.origin)
            and np.array_equal(self.heights, other.heights)
        )

    def __hash__(self) -> int:
        return hash((self.spacing, self.origin, np.asarray(self.heights).tobytes()))

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        n, m = np.shape(self.heights)
        across = _splines((x - self.origin[0]) / self.spacing[0], n)
        along = _splines((y - self.origin[1]) / self.spacing[1], m)
        return ca.mtimes([across.T, ca.DM(self._coefficients), along])

    @cached_property
    def _coefficients(self) -> Array:
        """Coefficients c_ij (n + 2, m + 2) [m]; there is one more B-spline than samples at each end."""
        n, m = np.shape(self.heights)
        right = np.zeros((n + 2, m + 2))
        right[1:-1, 1:-1] = self.heights
        return np.linalg.solve(_collocation(m), np.linalg.solve(_collocation(n), right).T).T


def _collocation(n: int) -> Array:
    """Rows: not-a-knot at the first end, the n samples, not-a-knot at the last end.

    On a regular grid the splines' values at a sample are 1/6, 4/6, 1/6. The third derivative is continuous at the
    second sample if the fourth difference of the coefficients is zero.
    """
    matrix = np.zeros((n + 2, n + 2))
    for i in range(n):
        matrix[i + 1, i : i + 3] = np.array([1.0, 4.0, 1.0]) / 6.0
    matrix[0, :5] = matrix[-1, -5:] = [1.0, -4.0, 6.0, -4.0, 1.0]
    return matrix


def _splines(u: ca.SX, n: int) -> ca.SX:
    """Values (n + 2,) of the B-splines at u, in units of the spacing; at most four are nonzero, from floor(u) on."""
    inside = ca.fmin(ca.fmax(u, 0.0), n - 1.0)
    piece = ca.fmin(ca.floor(inside), n - 2.0)
    s = inside - piece
    values = ((1 - s) ** 3, 4 + s * s * (3 * s - 6), 1 + s * (3 + s * (3 - 3 * s)), s**3)
    slopes = (-3 * (1 - s) ** 2, s * (9 * s - 12), 3 + s * (6 - 9 * s), 3 * s * s)
    parts = [(value + slope * (u - inside)) / 6.0 for value, slope in zip(values, slopes, strict=True)]
    return ca.vertcat(*(sum((piece == i - k) * part for k, part in enumerate(parts)) for i in range(n + 2)))
