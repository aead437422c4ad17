import coal
import numpy as np
import pytest
import trimesh

from robotraj.replay_page.scene.shapes import PLANE_SIDE, rod, shape_part, tube


def solid(part) -> trimesh.Trimesh:
    return trimesh.Trimesh(part.vertices.astype(float), part.faces, process=True)


@pytest.mark.parametrize(
    ("shape", "volume", "low", "high"),
    [
        (coal.Box(1.0, 2.0, 3.0), 6.0, [-0.5, -1.0, -1.5], [0.5, 1.0, 1.5]),
        (coal.Sphere(0.5), np.pi / 6.0, [-0.5] * 3, [0.5] * 3),
        (coal.Ellipsoid(0.5, 1.0, 1.5), np.pi, [-0.5, -1.0, -1.5], [0.5, 1.0, 1.5]),
        (coal.Cylinder(0.5, 2.0), np.pi / 2.0, [-0.5, -0.5, -1.0], [0.5, 0.5, 1.0]),
        (coal.Capsule(0.5, 2.0), np.pi * (0.5 + 1.0 / 6.0), [-0.5, -0.5, -1.5], [0.5, 0.5, 1.5]),
        (coal.Cone(0.5, 2.0), np.pi / 6.0, [-0.5, -0.5, -1.0], [0.5, 0.5, 1.0]),
    ],
    ids=lambda value: type(value).__name__ if hasattr(value, "getNodeType") else "",
)
def test_a_primitive_has_its_volume_and_its_box(shape, volume, low, high):
    mesh = solid(shape_part(shape))
    assert mesh.volume == pytest.approx(volume, rel=0.03)  # a polyhedron inscribed in the round shape
    assert mesh.volume <= volume * (1.0 + 1e-4)
    np.testing.assert_allclose(mesh.bounds, [low, high], atol=0.01)


def test_the_cone_points_up():
    part = shape_part(coal.Cone(0.5, 2.0))
    tip = part.vertices[np.argmax(part.vertices[:, 2])]
    np.testing.assert_allclose(tip, [0.0, 0.0, 1.0], atol=1e-4)


@pytest.mark.parametrize("kind", [coal.Plane, coal.Halfspace])
def test_a_plane_is_a_square_at_its_offset(kind):
    normal = np.array([0.6, 0.0, 0.8])
    part = shape_part(kind(normal, 0.5))
    heights = part.vertices @ normal
    np.testing.assert_allclose(heights.max(), 0.5, atol=1e-4)
    assert np.ptp(heights) == pytest.approx(1e-3, abs=2e-4)
    assert np.ptp(part.vertices[:, 1]) == pytest.approx(PLANE_SIDE, rel=1e-4)


def test_a_mesh_held_in_memory_is_read_back():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    held = coal.BVHModelOBBRSS()
    held.beginModel(len(mesh.faces), len(mesh.vertices))
    held.addVertices(mesh.vertices)
    held.addTriangles(mesh.faces)
    held.endModel()
    assert solid(shape_part(held)).volume == pytest.approx(mesh.volume, rel=1e-4)


def test_a_shape_without_extent_gives_nothing_and_an_unknown_kind_is_named():
    assert shape_part(coal.Sphere(0.0)) is None
    with pytest.raises(LookupError, match="TriangleP"):
        shape_part(coal.TriangleP(np.zeros(3), np.eye(3)[0], np.eye(3)[1]))


def test_a_rod_reaches_from_end_to_end():
    start, end = np.array([0.1, 0.2, 0.3]), np.array([0.4, -0.2, 0.9])
    axis = (end - start) / np.linalg.norm(end - start)
    along = (rod(start, end, 0.05).vertices - start) @ axis
    np.testing.assert_allclose([along.min(), along.max()], [-0.05, np.linalg.norm(end - start) + 0.05], atol=1e-4)


def test_a_tube_keeps_its_radius_and_runs_in_order():
    s = np.linspace(0.0, 3.0, 40)
    line = np.column_stack([np.cos(s), np.sin(s), 0.3 * s])
    part = tube(line, 0.01, sides=6)
    rings = part.vertices.reshape(40, 6, 3)
    np.testing.assert_allclose(np.linalg.norm(rings - line[:, None], axis=2), 0.01, rtol=1e-4)
    assert part.faces.shape == (39 * 12, 3)
    assert np.array_equal(part.faces.reshape(39, -1).min(axis=1) // 6, np.arange(39))
    assert np.array_equal(part.faces.reshape(39, -1).max(axis=1) // 6, np.arange(1, 40))
