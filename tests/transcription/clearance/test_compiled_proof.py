"""The compiled proof of distances agrees with dense samples, and with the proof by speeds of joints."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.clearance.proof import shortfalls

BOX = rt.obstacles.Box((0.1, 0.1, 0.3), (0.52, 0.07, 0.47))


@pytest.fixture(scope="module")
def pairs() -> ClearancePairs:
    return rt.CollisionFree([BOX, rt.obstacles.Cylinder(0.1, 0.3, (-0.3, 0.4, 0.5))]).pairs(rt.load("ur5"))


def motion(seed: int) -> PiecewisePolynomial:
    """Cubics through random configurations, on intervals of unequal length."""
    values = np.random.default_rng(seed).uniform(-1.2, 1.2, (5, 4, 6))
    values[1:, 0] = values[:-1, -1]
    values[:, 1:3] = values[:, :1] + 0.3 * values[:, 1:3]
    sites = [np.linspace(0.0, 1.0, 4)] * 5
    return PiecewisePolynomial(np.array([0.0, 0.3, 0.5, 1.0, 1.2, 2.0]), sites, list(values))


@pytest.mark.parametrize("seed", range(4))
def test_what_is_short_is_what_dense_samples_find_short(pairs: ClearancePairs, seed: int) -> None:
    x = motion(seed)
    found = shortfalls(pairs, x)
    short = set(zip(found.intervals.tolist(), found.pairs.tolist(), strict=True))
    assert len(short) == len(found.pairs)
    for interval in range(5):
        times = np.linspace(*x.breaks[interval : interval + 2], 400)
        least = pairs.distances(x(times, interval), times).min(axis=0)
        for pair in np.flatnonzero(least < 0.0).tolist():
            assert (interval, pair) in short
        for pair in np.flatnonzero(least > 1e-4).tolist():
            assert (interval, pair) not in short
    for interval, pair, distance, time in zip(found.intervals, found.pairs, found.distances, found.times, strict=True):
        at = pairs.distances(x(np.array([time]), int(interval)), np.array([time]))[0, pair]
        assert at - 1e-4 <= distance <= at + 1e-12


def test_distances_in_the_compiled_module_are_those_in_numpy(pairs: ClearancePairs) -> None:
    q = np.random.default_rng(1).uniform(-2, 2, (40, 6))
    found = pairs.distances(q, np.zeros(40))
    for pair in range(0, len(pairs), 97):
        exact = pairs.distances_of(np.full(40, pair), q, np.zeros(40))
        np.testing.assert_allclose(found[:, pair], exact, atol=1e-12)
    centres = pairs.spheres.centres(pairs.robot, q)[:, 3]
    np.testing.assert_allclose(pairs.centres_of(np.full(40, 3), q), centres, atol=1e-12)
