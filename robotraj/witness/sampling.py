"""Dense samples of a planned phase, interval by interval, both ends of each included.

Written on NumPy's Chebyshev series, apart from the Lagrange polynomials that the plan itself was made with.
Source: Trefethen, Spectral Methods in MATLAB (2000), chapter 6.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from robotraj.witness.protocols import Array, PhaseSolutionLike


class Stretch(NamedTuple):
    """One interval of a phase: its index, ends [s] and sample times (m,)."""

    interval: int
    begin: float
    end: float
    times: Array


def stretches(planned: PhaseSolutionLike, samples: int) -> Iterator[Stretch]:
    """Intervals that have a length, sampled at ``samples`` Chebyshev-Lobatto points.

    On these points a polynomial of degree below ``samples`` is differentiated exactly by ``time_derivative``.
    """
    knots = np.asarray(planned.knots, dtype=float)
    sites = 0.5 * (1.0 + chebyshev.chebpts2(samples))
    for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        if end > begin:
            yield Stretch(k, float(begin), float(end), np.clip(begin + (end - begin) * sites, begin, end))


def time_derivative(values: Array, stretch: Stretch) -> Array:
    """Differentiate the polynomials through values (m, n) at the times of a stretch."""
    return _differentiation(len(stretch.times)) @ values * (2.0 / (stretch.end - stretch.begin))


@lru_cache(maxsize=16)
def _differentiation(count: int) -> Array:
    """Matrix from values on Chebyshev-Lobatto points of [-1, 1] to derivatives there."""
    sites = chebyshev.chebpts2(count)
    slopes = [chebyshev.chebval(sites, chebyshev.chebder(unit)) for unit in np.eye(count)]
    return np.column_stack(slopes) @ np.linalg.inv(chebyshev.chebvander(sites, count - 1))
