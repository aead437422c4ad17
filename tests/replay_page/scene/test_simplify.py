"""Large meshes are simplified for the page: fewer triangles at the same places."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from robotraj.replay_page.scene.simplify import MOST, simplified
from tests.replay_page.scene.parts import read_mesh


def test_a_small_mesh_is_not_changed() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    vertices, faces = simplified(ball.vertices, ball.faces)
    assert vertices is ball.vertices and faces is ball.faces


def test_a_ball_stays_a_closed_ball_seen_from_outside() -> None:
    ball = trimesh.creation.icosphere(subdivisions=5)
    vertices, faces = simplified(ball.vertices, ball.faces, 3000)
    assert 700 < len(faces) <= 3000
    few = trimesh.Trimesh(vertices, faces, process=False)
    assert few.volume == pytest.approx(4 * np.pi / 3, rel=0.05)
    assert few.area == pytest.approx(4 * np.pi, rel=0.05)
    assert np.abs(np.linalg.norm(vertices, axis=1) - 1.0).max() < 0.05


def test_a_flat_mesh_and_a_single_triangle_left_are_handled() -> None:
    grid = np.mgrid[0:40, 0:40].reshape(2, -1).T
    points = np.column_stack([grid, np.zeros(len(grid))]).astype(float)
    corners = np.arange(1600).reshape(40, 40)[:-1, :-1].ravel()
    faces = np.concatenate(
        [np.stack([corners, corners + 40, corners + 1], 1), np.stack([corners + 40, corners + 41, corners + 1], 1)]
    )
    vertices, few = simplified(points, faces, 500)
    assert 0 < len(few) <= 500 and np.all(vertices[:, 2] == 0.0)
    assert len(simplified(points, faces, 1)[1]) <= 1


def test_a_file_with_more_triangles_than_a_page_shows_is_simplified(tmp_path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=7)
    ball.export(tmp_path / "ball.stl")
    (part,) = read_mesh(str(tmp_path / "ball.stl"))
    assert len(ball.faces) > MOST >= len(part.faces) > 1000
