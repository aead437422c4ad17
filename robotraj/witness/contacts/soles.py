"""Clearance between the points of a ``GroundClearance``, where an edge of the ground may penetrate a sole.

Over a plane it is enough to check the corners of a sole. Over other ground, points on all segments between two corners
are checked. The straight edge of a step enters a flat sole through its rim.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from typing import NamedTuple, cast

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.point import FramePoint, Point
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground
from robotraj.problem.constraints.base import BoundConstraint
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.clearance_geometry import ClearancePoint, spots_of
from robotraj.witness.checks.points import points_of
from robotraj.witness.checks.watch import Watch
from robotraj.witness.protocols import PhaseSolutionLike
from robotraj.witness.sampling import interval_samples

PLACES = np.linspace(0.0, 1.0, 41)[1:-1]
"""Checked points of a segment, without its ends, which are rows of the constraint."""


class _Segment(NamedTuple):
    """A segment of a rigid sole or shape, and the ground under it."""

    first: ClearancePoint
    second: ClearancePoint
    ground: Ground
    watch: Watch


def sole_watches(
    planned: PhaseSolutionLike, constraints: Sequence[BoundConstraint], samples: int, clock: Callable[[], None]
) -> list[Watch]:
    """Watch the clearance of all segments between points of one sole or shape, where it has a constant height."""
    segments = [segment for bound in constraints for segment in _segments_of(planned, bound)]
    if not segments:
        return []
    for part in interval_samples(planned, samples):
        clock()
        points = points_of(planned, part.times, part.interval)
        for segment in segments:
            segment.watch.see(part.times, _least_gap(segment, points))
    return [segment.watch for segment in segments]


def _segments_of(planned: PhaseSolutionLike, bound: BoundConstraint) -> list[_Segment]:
    source = bound.source
    if not isinstance(source, GroundClearance) or not isinstance(source.height, int | float | np.number):
        return []
    ground = as_ground(source.ground)
    if ground.even:
        return []
    bodies: dict[tuple[str, str], list[ClearancePoint]] = {}
    for spot in spots_of(source.frames, realised(planned)):
        # The lowest point of a disc is on no segment.
        if spot.axis is None:
            bodies.setdefault((spot.frame, spot.shape), []).append(spot)
    return [
        _Segment(first, second, ground, Watch(Row("ground clearance", "m", float(source.height), np.inf, label)))
        for body in bodies.values()
        for first, second in combinations(body, 2)
        for label in [f"{first.label} to {second.label}"]
    ]


def _least_gap(segment: _Segment, points: Sequence[Point]) -> Array:
    """Return the least vertical distance (m,) of a segment from the ground [m] at each of m points."""
    first, second = (
        np.array([[float(entry) for entry in spot.position(cast(FramePoint, point))] for point in points])
        for spot in (segment.first, segment.second)
    )
    places = first[:, None, :] + PLACES[None, :, None] * (second - first)[:, None, :]
    radii = segment.first.radius + PLACES * (segment.second.radius - segment.first.radius)
    height, slope_x, slope_y = (np.asarray(v) for v in segment.ground.plane(places[..., 0], places[..., 1]))
    gaps = places[..., 2] - height - radii * np.sqrt(1.0 + slope_x**2 + slope_y**2)
    return np.asarray(gaps.min(axis=1))
