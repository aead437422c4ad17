"""Dense samples of the intervals of a planned phase, both ends of each included.

NumPy's Chebyshev series are used, not the Lagrange polynomials of the planner.
Source: Trefethen, Spectral Methods in MATLAB (2000), chapter 6.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.witness.protocols import PhaseSolutionLike

CHUNK = 16
"""Intervals that are sampled in one call; the time limit is checked between calls."""


class IntervalSamples(NamedTuple):
    """Intervals of a phase with their sample times.

    Attributes
    ----------
    intervals : ndarray (k,)
        Indices of the intervals.
    begins, ends : ndarray (k,)
        Ends of the intervals [s].
    sites : ndarray (m,)
        Places of the samples in each interval, in [0, 1].
    """

    intervals: NDArray[np.int_]
    begins: Array
    ends: Array
    sites: Array

    @property
    def times(self) -> Array:
        """Sample times (k m,) [s]."""
        spread = self.begins[:, None] + (self.ends - self.begins)[:, None] * self.sites
        return np.clip(spread, self.begins[:, None], self.ends[:, None]).ravel()

    @property
    def interval(self) -> NDArray[np.int_]:
        """Interval (k m,) of each sample."""
        return np.repeat(self.intervals, len(self.sites))


def interval_samples(
    planned: PhaseSolutionLike, samples: int, sites: Array | None = None, only: Collection[int] | None = None
) -> Iterator[IntervalSamples]:
    """Yield the intervals whose length is not zero, ``CHUNK`` at a time, with Chebyshev-Lobatto points of each.

    At these points a polynomial of degree below ``samples`` is differentiated exactly by ``time_derivative``.

    Parameters
    ----------
    sites : ndarray (m,), optional
        Other places of the samples, in [0, 1].
    only : collection of int, optional
        The intervals to sample.
    """
    knots = np.asarray(planned.knots, dtype=float)
    places = 0.5 * (1.0 + chebyshev.chebpts2(samples)) if sites is None else sites
    chosen = [k for k in range(len(knots) - 1) if knots[k + 1] > knots[k] and (only is None or k in only)]
    for start in range(0, len(chosen), CHUNK):
        part = np.array(chosen[start : start + CHUNK])
        yield IntervalSamples(part, knots[part], knots[part + 1], places)


def time_derivative(values: Array, part: IntervalSamples) -> Array:
    """Return the derivatives (k m, n) of the polynomials through values (k m, n) at the times of ``part``."""
    count = len(part.sites)
    by_interval = values.reshape(len(part.intervals), count, -1)
    slopes = _differentiation(count) @ by_interval * (2.0 / (part.ends - part.begins))[:, None, None]
    return np.asarray(slopes.reshape(values.shape))


@lru_cache(maxsize=16)
def _differentiation(count: int) -> Array:
    """Return the matrix from values at Chebyshev-Lobatto points of [-1, 1] to derivatives there."""
    sites = chebyshev.chebpts2(count)
    slopes = [chebyshev.chebval(sites, chebyshev.chebder(unit)) for unit in np.eye(count)]
    return np.column_stack(slopes) @ np.linalg.inv(chebyshev.chebvander(sites, count - 1))
