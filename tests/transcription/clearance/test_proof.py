"""The proof of distances between the points: what it accepts holds, and what it reports is short."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.polynomials import lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.clearance.proof import shortfalls


def motion(seed: int, intervals: int = 6) -> PiecewisePolynomial:
    """A random cubic on every interval, rather slow."""
    rng = np.random.default_rng(seed)
    sites = lobatto_sites(4)
    knots = np.cumsum(rng.normal(size=(intervals + 1, 6)) * 0.3, axis=0) + [0, -1.5, 1, 0, 0, 0]
    values = []
    for k in range(intervals):
        inner = knots[k] + sites[:, None] * (knots[k + 1] - knots[k])
        inner[1:-1] += 0.05 * rng.normal(size=(2, 6))
        values.append(np.hstack([inner, np.zeros_like(inner)]))
    return PiecewisePolynomial(np.linspace(0, 1, intervals + 1), [sites] * intervals, values)


@pytest.fixture(scope="module")
def arm() -> rt.Robot:
    return rt.load("ur5")


def pairs_with(arm: rt.Robot, margin: float) -> ClearancePairs:
    box = rt.obstacles.Box((0.2, 0.3, 0.4), (0.45, 0.1, 0.3))
    ball = rt.obstacles.Sphere(0.1, lambda t: (0.3, 0.9 - t, 0.6))
    return rt.CollisionFree([box, ball], margin, self_collision=False).pairs(arm)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_not_reported_keeps_its_distance(arm: rt.Robot, seed: int) -> None:
    pairs, x = pairs_with(arm, 0.01), motion(seed)
    found = shortfalls(pairs, x)
    times = np.linspace(0, 1, 4001)
    intervals = x.locate(times)
    dense = pairs.distances(x(times)[:, :6], times)
    short = set(zip(found.intervals.tolist(), found.pairs.tolist(), strict=True))
    for k in range(6):
        least = dense[intervals == k].min(axis=0)
        below = np.flatnonzero(least < pairs.margin)
        assert {(k, int(pair)) for pair in below} <= short
    for interval, pair, time, distance in zip(found.intervals, found.pairs, found.times, found.distances, strict=True):
        assert x.locate(time) == interval or np.isclose(time, x.breaks).any()
        assert distance < pairs.margin
        seen = pairs.distances_of(np.array([pair]), x(np.array([time]))[:, :6], np.array([time]))[0]
        assert seen <= pairs.margin + 1e-3 and distance <= seen + 1e-9
    assert found.least <= dense.min() + 5e-2


def test_a_motion_far_from_everything_is_proved(arm: rt.Robot) -> None:
    far = rt.CollisionFree([rt.obstacles.Sphere(0.1, (0, 0, 5))], self_collision=False).pairs(arm)
    found = shortfalls(far, motion(0))
    assert not found.pairs.size and found.least > 2.0


def test_a_link_deep_inside_a_moving_ball_is_found_without_dividing_its_whole_motion(
    arm: rt.Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only pieces that may be the nearest are halved; the least distance is that of dense samples."""
    ball = rt.obstacles.Sphere(0.4, lambda t: (0.3 + 0.01 * t, 0.1, 0.5))
    pairs, x = rt.CollisionFree([ball], 0.01, self_collision=False).pairs(arm), motion(1)
    counts, distances_of = [0], ClearancePairs.distances_of
    monkeypatch.setattr(
        ClearancePairs,
        "distances_of",
        lambda self, pair, *given: (counts.append(len(pair)), distances_of(self, pair, *given))[1],
    )
    found = shortfalls(pairs, x)
    times = np.linspace(0, 1, 6001)
    dense = pairs.distances(x(times)[:, :6], times)
    assert found.least == pytest.approx(dense.min(), abs=1e-3) and found.distances.min() == found.least
    assert sum(counts) < 256 * found.pairs.size  # eight halvings of every piece are 510
