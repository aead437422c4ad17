"""Triangles of collision shapes: their hull contains the shape, whatever its kind."""

import coal
import numpy as np
import pytest
from scipy.spatial import ConvexHull

import robotraj as rt
from robotraj.robot.collision.tessellation import SIDES, subdivided, triangles_of

CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])


def convex():
    corners = coal.StdVec_Vec3s()
    for corner in CORNERS:
        corners.append(corner)
    faces = coal.StdVec_Triangle()
    for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)):
        faces.append(coal.Triangle(*face))
    return coal.Convex(corners, faces)


def surface(kind):
    """Return 2000 seeded points of the surface of a shape (or of the edge that is its silhouette)."""
    rng = np.random.default_rng(4)
    directions = rng.normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    if kind == "ellipsoid":
        return directions * [0.5, 1.0, 1.5]
    if kind == "box":
        return np.sign(directions) * [0.1, 0.2, 0.3]
    if kind == "convex":
        return CORNERS
    rim = directions[:, :2] / np.linalg.norm(directions[:, :2], axis=1)[:, None]
    height = rng.uniform(-1.0, 1.0, 2000)
    radius = 0.3 * ((1.0 - height) / 2.0 if kind == "cone" else np.ones(2000))
    return np.column_stack([rim * radius[:, None], 0.4 * height])


@pytest.mark.parametrize(
    ("kind", "shape", "volume"),
    [
        ("box", coal.Box(0.2, 0.4, 0.6), 0.2 * 0.4 * 0.6),
        ("ellipsoid", coal.Ellipsoid(0.5, 1.0, 1.5), 1.0 * 2.0 * 3.0),
        ("cylinder", coal.Cylinder(0.3, 0.8), SIDES * np.tan(np.pi / SIDES) * 0.09 * 0.8),
        ("cone", coal.Cone(0.3, 0.8), SIDES * np.tan(np.pi / SIDES) * 0.09 * 0.8),
        ("convex", convex(), 1.0),
    ],
)
def test_the_hull_of_the_triangles_contains_the_shape(kind, shape, volume):
    """A box around a box, an ellipsoid; a prism around a cylinder, a cone; a hull itself: volumes in closed form."""
    triangles = triangles_of(shape, kind)
    hull = ConvexHull(triangles.reshape(-1, 3))
    assert hull.volume == pytest.approx(volume, rel=1e-12)
    outside = surface(kind) @ hull.equations[:, :3].T + hull.equations[:, 3]
    assert outside.max() <= 1e-12
    # Faces are counter-clockwise from outside: the divergence theorem gives the volume with its sign.
    assert np.linalg.det(triangles).sum() / 6.0 == pytest.approx(volume, rel=1e-12)


def test_a_shape_without_an_end_is_refused_by_its_name():
    with pytest.raises(rt.InputError, match="'floor' is a Halfspace.*use a mesh"):
        triangles_of(coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0), "floor")


def test_subdivision_keeps_the_area_and_shortens_every_edge():
    triangles = triangles_of(coal.Box(0.2, 0.4, 0.6), "box")
    parts = subdivided(triangles, 0.07)

    def area(of):
        return np.linalg.norm(np.cross(of[:, 1] - of[:, 0], of[:, 2] - of[:, 0]), axis=1).sum() / 2.0

    assert area(parts) == pytest.approx(area(triangles), rel=1e-12)
    assert np.linalg.norm(parts - np.roll(parts, 1, axis=1), axis=2).max() <= 0.07
    assert subdivided(np.zeros((0, 3, 3)), 0.07).shape == (0, 3, 3)
