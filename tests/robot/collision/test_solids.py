"""Shapes as solids: overlaps that surfaces show, those that they hide, and depths in closed form."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from robotraj.robot.collision.solids import Placed, Solid, depth, distance, one_inside, touch
from robotraj.robot.collision.tessellation import box_triangles, sphere_points, surface_of


def mesh(half: tuple[float, float, float]) -> Solid:
    """A closed mesh of a box with half its sides [m]."""
    model = coal.BVHModelOBBRSS()
    triangles = box_triangles(np.array(half))
    model.beginModel(len(triangles), 3 * len(triangles))
    for corners in triangles:
        model.addTriangle(*corners)
    model.endModel()
    return Solid(model)


def at(solid: Solid, *position: float) -> Placed:
    return Placed(solid, np.eye(3), np.array(position))


def test_a_small_box_inside_the_mesh_of_a_large_one_overlaps_although_no_surfaces_cross() -> None:
    """The deepest point of a cube of half side a in the middle of one of half side b lies b - a below its surface."""
    small, large = at(mesh((0.1, 0.1, 0.1)), 0, 0, 0), at(mesh((0.5, 0.5, 0.5)), 0, 0, 0)
    assert not touch(small, large) and distance(small, large) == pytest.approx(0.4)
    assert one_inside(small, large) and one_inside(large, small)
    assert depth(small, large) == pytest.approx(0.4, abs=1e-6)


def test_a_solid_box_inside_a_mesh_overlaps_and_one_beside_it_does_not() -> None:
    large = at(mesh((0.5, 0.5, 0.5)), 0, 0, 0)
    for solid in (Solid(coal.Box(0.1, 0.1, 0.1)), Solid(coal.Sphere(0.05)), Solid(coal.Capsule(0.05, 0.1))):
        assert one_inside(at(solid, 0.2, 0, 0), large) and not one_inside(at(solid, 0.7, 0, 0), large)


def test_meshes_that_cross_overlap_although_their_distance_is_not_negative() -> None:
    """Two cubes that overlap by 0.03 m along x reach 0.03 m into each other."""
    first, second = at(mesh((0.1, 0.1, 0.1)), 0, 0, 0), at(mesh((0.1, 0.08, 0.08)), 0.17, 0, 0)
    assert touch(first, second) and distance(first, second) >= 0.0
    assert depth(first, second) == pytest.approx(0.03, abs=1e-6)


@pytest.mark.parametrize("gap", [1e-3, 0.02])
def test_shapes_are_nearer_than_margins_above_their_gap_alone(gap: float) -> None:
    first, second = at(mesh((0.1, 0.1, 0.1)), 0, 0, 0), at(mesh((0.1, 0.1, 0.1)), 0.2 + gap, 0, 0)
    assert touch(first, second, 1.01 * gap) and not touch(first, second, 0.99 * gap) and not touch(first, second)


@pytest.mark.parametrize(
    "shape", [coal.Box(0.2, 0.1, 0.7), coal.Cylinder(0.1, 0.5), coal.Sphere(0.2), coal.Capsule(0.05, 0.4)]
)
def test_the_balls_of_a_shape_enclose_it(shape: coal.CollisionGeometry) -> None:
    solid = Solid(shape)
    centres, radii = solid.balls
    corners = solid.triangles.reshape(-1, 3)
    inside = np.all((corners >= solid.box[0] - 1e-9) & (corners <= solid.box[1] + 1e-9), axis=1)
    held = np.linalg.norm(corners[:, None] - centres, axis=2) <= radii + 1e-9
    assert inside.any() and held[inside].any(axis=1).all()


def test_an_unbounded_shape_is_near_everything() -> None:
    floor = Solid(coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0))
    assert np.isinf(floor.balls[1]).all() and not len(floor.corners)
    assert touch(at(floor, 0, 0, 0), at(mesh((0.1, 0.1, 0.1)), 0, 0, 0.05))


def test_points_near_the_surface_of_a_ball_lie_on_it() -> None:
    assert np.allclose(np.linalg.norm(surface_of(coal.Sphere(0.3)), axis=2), 0.3)
    assert np.allclose(np.linalg.norm(sphere_points(), axis=1), 1.0)
