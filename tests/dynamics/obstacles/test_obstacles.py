"""Signed distances of obstacles: exact against coal outside, defined and outward inside, poses in time."""

from __future__ import annotations

import pickle

import casadi as ca
import coal
import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.obstacles import Obstacle, primitives_of

CLOUD = 0.3 * np.random.default_rng(1).normal(size=(20, 3))
SHAPES: dict[str, Obstacle] = {
    "box": rt.obstacles.Box((0.3, 0.4, 0.5)),
    "sphere": rt.obstacles.Sphere(0.2),
    "cylinder": rt.obstacles.Cylinder(0.2, 0.5),
    "capsule": rt.obstacles.Capsule(0.2, 0.5),
    "half space": rt.obstacles.HalfSpace((1, 2, 3), 0.1),
    "convex mesh": rt.obstacles.ConvexMesh(CLOUD),
}


def coal_shape(shape: Obstacle) -> coal.CollisionGeometry:
    match shape:
        case rt.obstacles.Box():
            return coal.Box(*shape.sides)
        case rt.obstacles.Sphere():
            return coal.Sphere(shape.radius)
        case rt.obstacles.Cylinder():
            return coal.Cylinder(shape.radius, shape.length)
        case rt.obstacles.Capsule():
            return coal.Capsule(shape.radius, shape.length)
        case rt.obstacles.HalfSpace():
            return coal.Halfspace(np.array(shape.normal), shape.offset)
        case rt.obstacles.ConvexMesh():
            points = coal.StdVec_Vec3s()
            points.extend(list(shape.vertices))
            return coal.Convex.convexHull(points, False, "")
    raise AssertionError(shape)


@pytest.fixture(params=sorted(SHAPES))
def shape(request: pytest.FixtureRequest) -> Obstacle:
    return SHAPES[request.param]


def test_distances_of_small_balls_are_those_of_coal(shape: Obstacle) -> None:
    points = np.random.default_rng(0).normal(size=(60, 3)) * 0.5
    mine = shape.distance(points)
    radius, other = 1e-3, coal_shape(shape)
    for point, distance in zip(points, mine, strict=True):
        found = coal.distance(
            coal.Sphere(radius), coal.Transform3s(np.eye(3), point), other, coal.Transform3s(), REQUEST, RESULT()
        )
        if distance > 2 * radius:
            assert found + radius == pytest.approx(distance, abs=2e-6)
        elif distance < -2 * radius:
            assert found < 0.0


REQUEST = coal.DistanceRequest()
RESULT = coal.DistanceResult


def test_a_pose_may_be_a_function_of_time() -> None:
    box = rt.obstacles.Box((1, 1, 1), lambda t: (t, 0, ca.sin(t)), lambda t: (0, 0, ca.sin(t), ca.cos(t)))
    assert box.moves and not SHAPES["box"].moves
    times = np.array([0.0, 0.3, 1.0])
    positions, rotations = box.poses(times)
    np.testing.assert_allclose(positions, np.column_stack([times, 0 * times, np.sin(times)]))
    for time, rotation in zip(times, rotations, strict=True):
        angle = 2 * time
        expected = [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
        np.testing.assert_allclose(rotation, expected, atol=1e-12)
        np.testing.assert_allclose(box.pose(float(time))[1], expected, atol=1e-12)


def test_primitives_hold_the_numbers_of_every_shape() -> None:
    arrays = primitives_of([*SHAPES.values(), SHAPES["box"]])
    assert arrays.labels[0] == "box 1" and arrays.labels[-1] == "box 2" and arrays.labels[1] == "sphere"
    np.testing.assert_allclose(arrays.dimensions[0, :3], [0.15, 0.2, 0.25])
    assert arrays.triangles[5].shape[1:] == (3, 3) and not arrays.triangles[0].size


@pytest.mark.parametrize(
    "make",
    [
        lambda: rt.obstacles.Box((1, 1, 0)),
        lambda: rt.obstacles.Box((1, 1)),
        lambda: rt.obstacles.Sphere(-1.0),
        lambda: rt.obstacles.Sphere(1.0, position=(0, 0)),
        lambda: rt.obstacles.Sphere(1.0, quaternion=(0, 0, 0, 2)),
        lambda: rt.obstacles.HalfSpace((0, 0, 0)),
        lambda: rt.obstacles.ConvexMesh(np.zeros((5, 3))),
        lambda: rt.obstacles.Box((1, 1, 1), position=lambda t: (t, t)),
        lambda: rt.obstacles.Box((1, 1, 1), frame=3),
    ],
)
def test_shapes_that_are_none_are_refused(make) -> None:
    with pytest.raises(rt.InputError):
        make()


def test_shapes_are_pickled(shape: Obstacle) -> None:
    again = pickle.loads(pickle.dumps(shape))
    points = np.random.default_rng(0).normal(size=(5, 3))
    np.testing.assert_array_equal(again.distance(points), shape.distance(points))


def test_an_obstacle_that_starts_to_move_has_bounded_speeds() -> None:
    leaving = rt.obstacles.Sphere(0.1, lambda t: (2.0 * ca.fmax(t - 2.0, 0.0), ca.fmin(t, 1.0), 0.0))
    found = leaving.speed_bounds(np.array([0.0, 0.5, 1.5, 1.75, 2.5, 3.0]))
    np.testing.assert_allclose(found, [1.0, 1.0, 0.0, 2.0, 2.0], atol=1e-12)
