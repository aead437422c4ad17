"""The support of a shape is that of its surface's points, which lie on it to their own fineness."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from robotraj.problem.clearance.link_parts import support
from robotraj.robot.collision.solids import Solid

SHAPES = {
    "sphere": coal.Sphere(0.3),
    "capsule": coal.Capsule(0.1, 0.5),
    "cylinder": coal.Cylinder(0.2, 0.5),
    "cone": coal.Cone(0.2, 0.5),
    "ellipsoid": coal.Ellipsoid(0.1, 0.2, 0.4),
    "box": coal.Box(0.1, 0.4, 0.9),
}


@pytest.mark.parametrize("name", SHAPES)
def test_half_spaces_that_touch(name: str) -> None:
    """A half-space d . p >= h is apart from the shape by h - support(d), by coal's own distance."""
    shape = SHAPES[name]
    directions = np.random.default_rng(5).standard_normal((20, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reached = support(Solid(shape), directions)
    for direction, height in zip(directions, reached, strict=True):
        wall = coal.Halfspace(-direction, -(height + 0.25))
        apart = coal.distance(
            shape, coal.Transform3s(), wall, coal.Transform3s(), coal.DistanceRequest(), coal.DistanceResult()
        )
        assert abs(apart - 0.25) < 1e-6


def test_mesh() -> None:
    """The support of a mesh is that of its vertices."""
    points = np.random.default_rng(6).standard_normal((40, 3))
    hull = coal.StdVec_Vec3s()
    hull.extend(list(points))
    solid = Solid(coal.Convex.convexHull(hull, True, ""))
    directions = np.eye(3)
    np.testing.assert_allclose(support(solid, directions), points.max(axis=0), atol=1e-12)
