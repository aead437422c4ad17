"""Places on the edges of rigid soles and shapes, which uneven ground may penetrate between two corners.

Over a plane the corners are enough. The straight nose of a step penetrates a flat sole through its rim. The gap is then
least where an edge of the sole crosses the nose. Over other uneven ground the places divide an edge into equal parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import cast

import casadi as ca
import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.problem.constraints.clearance_geometry import ClearancePoint
from robotraj.problem.scalars import Scalar

SPACING, MOST_PLACES = 0.025, 9
"""Largest distance [m] of places on an edge over ground without noses, and their greatest number."""
ALONG = 0.05
"""Fraction of an edge's length that is added to its extent across a nose, to avoid a pole for an edge along it."""


@dataclass(frozen=True)
class EdgePlace(OneLine):
    """A place on the edge between two points of one body.

    Attributes
    ----------
    first, second : ClearancePoint
    axis : int or None
        0 where the edge crosses the nose x = ``at``, 1 where it crosses y = ``at``; None for a fixed place.
    at : float
        Coordinate of the nose [m], or the fixed place, from 0 at the first point to 1 at the second.
    """

    first: ClearancePoint
    second: ClearancePoint
    axis: int | None
    at: float

    @property
    def label(self) -> str:
        """Name for reports."""
        where = f"at {self.at:.2g} of it" if self.axis is None else f"over {'xy'[self.axis]} = {self.at:.4g} m"
        return f"{self.first.label} to {self.second.label} {where}"

    def gap(self, point: FramePoint, ground: Ground) -> Scalar:
        """Vertical distance z - h(x, y) [m], less the radius along the ground's normal."""
        a, b = self.first.position(point), self.second.position(point)
        share = self._share(a, b)
        x, y, z = (a[i] + share * (b[i] - a[i]) for i in range(3))
        radius = self.first.radius + share * (self.second.radius - self.first.radius)
        height, slope_x, slope_y = ground.plane(x, y)
        return z - height - radius * (1.0 + slope_x * slope_x + slope_y * slope_y) ** 0.5

    def _share(self, a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
        """Return the place on the edge nearest to the nose, from 0 to 1."""
        if self.axis is None:
            return self.at
        across = b[self.axis] - a[self.axis]
        middle = 0.5 * (a[self.axis] + b[self.axis])
        soft = (ALONG * float(np.linalg.norm(np.subtract(self.second.offset, self.first.offset)))) ** 2
        share = 0.5 + (self.at - middle) * across / (across * across + soft)
        return cast("Scalar", ca.fmin(ca.fmax(share, 0.0), 1.0))


def edge_places(spots: Sequence[ClearancePoint], ground: Ground) -> list[EdgePlace]:
    """Return the places on all edges of bodies with several points; none over a plane."""
    if ground.even:
        return []
    bodies: dict[tuple[str, str], list[ClearancePoint]] = {}
    for spot in spots:
        # The lowest point of a disc is no end of an edge.
        if spot.axis is None:
            bodies.setdefault((spot.frame, spot.shape), []).append(spot)
    noses = [(axis, float(at)) for axis, values in enumerate(ground.noses()) for at in values]
    return [place for body in bodies.values() for pair in _edges(body) for place in _places(*pair, noses)]


def _places(first: ClearancePoint, second: ClearancePoint, noses: Sequence[tuple[int, float]]) -> list[EdgePlace]:
    if noses:
        return [EdgePlace(first, second, axis, at) for axis, at in noses]
    length = float(np.linalg.norm(np.subtract(second.offset, first.offset)))
    count = min(int(length / SPACING), MOST_PLACES)
    return [EdgePlace(first, second, None, (i + 1) / (count + 1)) for i in range(count)]


def _edges(body: Sequence[ClearancePoint]) -> list[tuple[ClearancePoint, ClearancePoint]]:
    """Return the pairs of points for which the ball with the pair as diameter contains no third point.

    This excludes the diagonals of boxes.
    """
    places = np.array([spot.offset for spot in body])
    squares = np.sum((places[:, None] - places[None]) ** 2, axis=-1)
    pairs = list(combinations(range(len(body)), 2))
    others = {(i, j): [k for k in range(len(body)) if k not in (i, j)] for i, j in pairs}
    return [
        (body[i], body[j])
        for i, j in pairs
        if np.all(squares[i, others[i, j]] + squares[j, others[i, j]] > (1.0 + 1e-9) * squares[i, j])
    ]
