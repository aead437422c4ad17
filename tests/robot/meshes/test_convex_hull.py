"""Convex hulls of points in space, in a plane, on a line, and at a place."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from robotraj.robot.meshes.arrays import MeshArrays
from robotraj.robot.meshes.convex_hull import convex_hull

RNG = np.random.default_rng(0)
SQUARE = 0.06 * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
POINTS = {
    "cloud": RNG.normal(size=(30, 3)),
    "sticker": SQUARE,
    "nearly flat": SQUARE + 1e-10 * RNG.normal(size=(4, 3)),
    "tilted": RNG.normal(size=(30, 2)) @ RNG.normal(size=(2, 3)),
    "line": np.outer([0.0, 1.0, 2.0], [1.0, 2.0, 3.0]),
    "place": np.full((3, 3), 0.2),
}


@pytest.mark.parametrize("name", POINTS)
@pytest.mark.parametrize("options", ["", "Qt"])
def test_a_ball_outside_is_as_far_from_the_hull_as_from_the_points_near_it(name: str, options: str) -> None:
    points = POINTS[name]
    hull, size = convex_hull(points, options), max(float(np.ptp(points, axis=0).max()), 1e-6)
    for direction in RNG.normal(size=(8, 3)):
        direction /= np.linalg.norm(direction)
        extreme = points[np.argmax(points @ direction)]
        ball, place = coal.Sphere(0.1), coal.Transform3s(np.eye(3), extreme + (0.1 + 0.5 * size) * direction)
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        found = coal.distance(hull, coal.Transform3s(), ball, place, request, result)
        # The plane through the extreme point across the direction supports the hull.
        assert found == pytest.approx(0.5 * size, abs=1e-5 * size + 1e-9)


def test_a_mesh_of_two_triangles_in_a_plane_has_a_hull() -> None:
    flat = MeshArrays(SQUARE, np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32))
    box = flat.hull(np.array([2.0, 1.0, 1.0]))
    box.computeLocalAABB()
    np.testing.assert_allclose(np.ptp([box.aabb_local.min_, box.aabb_local.max_], axis=0), [0.12, 0.06, 0], atol=1e-6)
