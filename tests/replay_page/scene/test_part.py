import numpy as np
import pytest
from trimesh import creation

from robotraj.replay_page.scene.part import merge_by_color, weld


def area(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (np.asarray(vertices, dtype=float)[faces[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def soup(mesh) -> tuple[np.ndarray, np.ndarray]:
    """The same surface with three own vertices for each face, as an STL file has them."""
    return mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3)


def test_a_box_keeps_sharp_edges():
    part = weld(*soup(creation.box(extents=[1.0, 2.0, 3.0])))
    assert part.faces.shape == (12, 3)
    assert part.vertices.shape == (24, 3)  # every corner three times, once for each side
    assert area(part.vertices, part.faces) == pytest.approx(22.0, rel=1e-4)


def test_a_sphere_stays_smooth():
    mesh = creation.icosphere(subdivisions=3)
    part = weld(*soup(mesh))
    assert len(part.vertices) == len(mesh.faces) // 2 + 2  # Euler: closed and merged everywhere


def test_a_crease_that_ends_splits_only_where_it_is_sharp():
    # A sheet folded along half of its middle line: vertices 0..2 below, 3..5 on the line, 6..8 above.
    x, y = np.meshgrid([0.0, 1.0, 2.0], [-1.0, 0.0, 1.0])
    z = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
    vertices = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    faces = np.array([[i, i + 1, i + 4] for i in (0, 1, 3, 4)] + [[i, i + 4, i + 3] for i in (0, 1, 3, 4)])
    part = weld(vertices, faces)
    copies = np.sum(np.all(np.isclose(part.vertices, [0.0, 0.0, 0.0], atol=1e-4), axis=1))
    assert copies == 1
    copies = np.sum(np.all(np.isclose(part.vertices, [2.0, 0.0, 0.0], atol=1e-4), axis=1))
    assert copies == 2


def test_rounding_moves_no_vertex_by_more_than_the_stated_step():
    rng = np.random.default_rng(3)
    vertices = rng.uniform(-0.4, 0.4, (300, 3))
    faces = np.arange(300).reshape(-1, 3)
    part = weld(vertices, faces)
    distance = np.abs(part.vertices[part.faces] - vertices[faces]).max()
    assert 0.0 < distance <= 0.5e-5 * np.ptp(vertices, axis=0).max() * (1.0 + 1e-6) + 3e-8


def test_faces_without_area_are_dropped_and_nothing_gives_none():
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]])
    assert weld(vertices, np.array([[0, 1, 2], [0, 1, 3], [0, 0, 1]])).faces.shape == (1, 3)
    assert weld(vertices, np.array([[0, 1, 3]])) is None
    assert weld(vertices, np.zeros((0, 3), dtype=int)) is None


@pytest.mark.parametrize(("subdivisions", "kind"), [(3, "uint16"), (7, "uint32")])
def test_indices_are_as_short_as_they_can_be(subdivisions, kind):
    mesh = creation.icosphere(subdivisions=subdivisions)
    assert weld(mesh.vertices, mesh.faces).faces.dtype.name == kind


def test_pieces_of_one_colour_become_one_part():
    box, ball = creation.box(), creation.icosphere(subdivisions=1)
    red, blue = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
    pieces = [
        (box.vertices, box.faces, red),
        (ball.vertices, ball.faces, blue),
        (box.vertices + 5.0, box.faces, red),
    ]
    parts = merge_by_color(pieces)
    assert [p.color for p in parts] == [red, blue]
    assert [len(p.faces) for p in parts] == [24, len(ball.faces)]
    assert parts[0].vertices.max() == pytest.approx(5.5, abs=1e-4)
