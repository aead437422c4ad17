"""Stage functions of distances: the values of the pairs, and exact derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.clearance.distance_functions import constants_of, function_of, key_of

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
def test_values_and_derivatives(pairs: ClearancePairs, kind: str) -> None:
    rng = np.random.default_rng(3)
    named = [p for p in range(len(pairs)) if (p >= pairs.against) == (kind == "link")]
    if kind != "link":
        named = [p for p in named if pairs.labels[pairs.second[p]] == kind]
    for pair in rng.choice(named, size=3).tolist():
        alike = [p for p in named if key_of(pairs, p) == key_of(pairs, pair)][:4]
        function = function_of(pairs, pair, (False, False))
        q = rng.uniform(-1, 1, size=(len(alike), 6))
        v = q[:, function.positions].T
        c = constants_of(pairs, np.array(alike)).T
        found = function.stage.evaluate("function", v, c).ravel()
        exact = pairs.distances_of(np.array(alike), q, np.zeros(len(alike)))
        # Deep inside, distances are smoothed.
        outside = exact + pairs.spheres.radius[pairs.first[alike]] > 0
        np.testing.assert_allclose(found[outside], exact[outside], atol=1e-12)
        step = 1e-6
        slopes = np.zeros((len(alike), len(v)))
        rows, columns = function.stage.jacobian_pattern
        slopes[:, columns] = function.stage.evaluate("jacobian", v, c).T
        for j in range(len(v)):
            d = step * np.eye(len(v))[j][:, None]
            up, down = (function.stage.evaluate("function", v + s * d, c).ravel() for s in (1, -1))
            np.testing.assert_allclose(slopes[:, j], (up - down) / (2 * step), atol=1e-6)


def test_a_moving_obstacle_reads_free_and_fixed_clocks() -> None:
    ball = rt.obstacles.Sphere(0.1, lambda t: (0.5 - t, 0.4, 0.6))
    pairs = rt.CollisionFree([ball], self_collision=False).pairs(rt.load("ur5"))
    pair, q, t0, duration, tau = len(pairs) - 1, np.full(6, 0.3), 0.2, 1.5, 0.4
    exact = pairs.distances_of(np.array([pair]), q[None], np.array([t0 + tau * duration]))
    own = constants_of(pairs, np.array([pair]))[0]
    for free in ((True, True), (False, True), (False, False)):
        function = function_of(pairs, pair, free)
        clock = [value for value, is_free in zip((t0, duration), free, strict=True) if is_free]
        fixed = [value for value, is_free in zip((t0, duration), free, strict=True) if not is_free]
        v, c = np.array([*q[function.positions], *clock]), np.array([tau, *fixed, *own])
        found = function.stage.evaluate("function", v[:, None], c[:, None])
        np.testing.assert_allclose(found.ravel(), exact, atol=1e-12)
