"""Dense samples of a planned phase, interval by interval, both ends of each included."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from robotraj.polynomials import differentiation, lobatto_sites
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
    sites = lobatto_sites(samples)
    for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        if end > begin:
            yield Stretch(k, float(begin), float(end), np.clip(begin + (end - begin) * sites, begin, end))


def time_derivative(values: Array, stretch: Stretch) -> Array:
    """Differentiate the polynomials through values (m, n) at the times of a stretch."""
    matrix = differentiation(lobatto_sites(len(stretch.times)))
    return matrix @ values / (stretch.end - stretch.begin)
