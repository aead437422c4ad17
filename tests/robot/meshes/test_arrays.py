"""Points that differ: each stands once among them, and every point has its place there."""

from __future__ import annotations

import numpy as np

from robotraj.robot.meshes.arrays import distinct


def test_points_are_their_distinct_ones_at_their_places() -> None:
    points = np.random.default_rng(0).integers(0, 3, (40, 3)).astype(float)
    first, place = distinct(points)
    np.testing.assert_array_equal(points[first][place], points)
    np.testing.assert_array_equal(points[first], np.unique(points, axis=0))
    assert all(not np.any(np.all(points[:k] == points[k], axis=1)) for k in first.tolist())


def test_no_points_have_none() -> None:
    assert [each.size for each in distinct(np.zeros((0, 3)))] == [0, 0]
