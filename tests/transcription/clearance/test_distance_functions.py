"""Stage functions of distances: the values of the pairs, and exact derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.clearance.distance_functions import DistanceFunction, constants_of, function_of, key_of
from robotraj.transcription.clearance.supporting_planes import heights, in_axes, planes

CLOUD = np.random.default_rng(5).normal(size=(8, 3)) * 0.1
KINDS = {
    "box": rt.obstacles.Box((0.2, 0.3, 0.4), (0.6, 0.1, 0.3), (0.5, 0.5, 0.5, 0.5)),
    "sphere": rt.obstacles.Sphere(0.1, (0.5, 0.4, 0.6)),
    "cylinder": rt.obstacles.Cylinder(0.1, 0.4, (-0.4, 0.2, 0.5), (0.6, 0, 0, 0.8)),
    "capsule": rt.obstacles.Capsule(0.1, 0.4, (-0.4, 0.2, 0.5), (0.6, 0, 0, 0.8)),
    "half space": rt.obstacles.HalfSpace((0.1, 0, 1), -0.5),
    "convex mesh": rt.obstacles.ConvexMesh(CLOUD, (0.4, 0.4, 0.4)),
}


@pytest.fixture(scope="module")
def pairs() -> ClearancePairs:
    return rt.CollisionFree(list(KINDS.values())).pairs(rt.load("ur5"))


@pytest.mark.parametrize("kind", [*KINDS, "link"])
def test_planes_touch_the_distance_at_one_motion_and_are_below_it_elsewhere(pairs: ClearancePairs, kind: str) -> None:
    rng = np.random.default_rng(3)
    named = [p for p in range(len(pairs)) if (p >= pairs.against) == (kind == "link")]
    if kind != "link":
        named = [p for p in named if pairs.labels[pairs.second[p]] == kind]
    for pair in rng.choice(named, size=3).tolist():
        alike = np.array([p for p in named if key_of(pairs, p) == key_of(pairs, pair)][:4])
        function = function_of(pairs, pair, (False, False))
        still = np.setdiff1d(np.arange(6), function.positions)
        q, others = (rng.uniform(-1, 1, size=(len(alike), 6)) for _ in range(2))
        q[:, still] = others[:, still] = pairs.robot.neutral[still]
        known = planes(pairs, alike, q)
        c = np.column_stack([constants_of(pairs, alike), known]).T

        def values(at: np.ndarray, function: DistanceFunction = function, c: np.ndarray = c) -> np.ndarray:
            return function.stage.evaluate("function", at[:, function.positions].T, c).ravel()

        exact, elsewhere = (pairs.distances_of(alike, each, np.zeros(len(alike))) for each in (q, others))
        np.testing.assert_allclose(values(q), exact, atol=1e-8)
        np.testing.assert_allclose(values(others), heights(pairs, alike, others, known), atol=1e-12)
        assert np.all(values(others) <= elsewhere + 1e-8)
        rows, columns = function.stage.jacobian_pattern
        slopes = np.zeros((len(alike), 6))
        slopes[:, function.positions[columns]] = function.stage.evaluate("jacobian", q[:, function.positions].T, c).T
        for j in range(6):
            step = 1e-6 * np.eye(6)[j]
            np.testing.assert_allclose(slopes[:, j], (values(q + step) - values(q - step)) / 2e-6, atol=1e-6)


def test_a_moving_obstacle_reads_free_and_fixed_clocks() -> None:
    ball = rt.obstacles.Sphere(0.1, lambda t: (0.5 - t, 0.4, 0.6))
    pairs = rt.CollisionFree([ball], self_collision=False).pairs(rt.load("ur5"))
    pair, q, t0, duration, tau = len(pairs) - 1, np.full(6, 0.3), 0.2, 1.5, 0.4
    exact = pairs.distances_of(np.array([pair]), q[None], np.array([t0 + tau * duration]))
    times = np.array([t0 + tau * duration])
    plane = in_axes(ball, times, planes(pairs, np.array([pair]), q[None], times))[0]
    own = [*constants_of(pairs, np.array([pair]))[0], *plane]
    for free in ((True, True), (False, True), (False, False)):
        function = function_of(pairs, pair, free)
        clock = [value for value, is_free in zip((t0, duration), free, strict=True) if is_free]
        fixed = [value for value, is_free in zip((t0, duration), free, strict=True) if not is_free]
        v, c = np.array([*q[function.positions], *clock]), np.array([tau, *fixed, *own])
        found = function.stage.evaluate("function", v[:, None], c[:, None])
        np.testing.assert_allclose(found.ravel(), exact, atol=1e-12)
