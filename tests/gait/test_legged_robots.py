"""The legged robots of the package: axes and limits of their joints, inertias, feet."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import folder

FEET = {
    "compass_walker": ("left_foot", "right_foot"),
    "five_link": ("left_foot", "right_foot"),
    "five_link_table": ("left_foot", "right_foot"),
    "hopper": ("foot",),
    "monopod": ("foot",),
}


def test_the_monopods_joints_move_its_foot_left_and_back():
    robot = rt.load("monopod")
    data = robot.model.createData()
    for q, foot in (
        ([0, 0, 0], [0, 0, -0.38]),
        ([np.pi / 6, 0, 0], [0, 0.16, -0.06 - 0.16 * 3**0.5]),
        ([0, np.pi / 6, 0], [-0.16, 0, -0.06 - 0.16 * 3**0.5]),
        ([0, 0, np.pi / 2], [-0.16, 0, -0.22]),
        ([0, -np.pi / 4, np.pi / 2], [0, 0, -0.06 - 0.16 * 2**0.5]),
    ):
        pin.framesForwardKinematics(robot.model, data, np.array(q, dtype=float))
        np.testing.assert_allclose(data.oMf[robot.frame("foot")].translation, foot, atol=1e-12)


LEG = ("left_hip", "left_knee", "right_hip", "right_knee")


@pytest.mark.parametrize(
    ("name", "joints", "mass", "effort", "velocity", "lower", "upper"),
    [
        ("five_link", LEG, 40, [100] * 4, [20] * 4, [-np.pi, 0] * 2, [np.pi] * 4),
        ("five_link_table", LEG, 40, [100] * 4, [20] * 4, [-np.pi, 0] * 2, [np.pi] * 4),
        ("compass_walker", ("left_hip", "right_hip"), 20, [50] * 2, [10] * 2, [-np.pi / 2] * 2, [np.pi / 2] * 2),
        ("hopper", ("hip", "leg"), 3.5, [20, 150], [15, 5], [-1.2, 0.3], [1.2, 0.7]),
        (
            "monopod",
            ("hip_abduction", "hip_flexion", "knee"),
            1.15,
            [2.7] * 3,
            [30] * 3,
            [-0.8, -1.6, 0],
            [0.8, 1.6, 2.8],
        ),
    ],
)
def test_joints_motors_masses_and_limits(name, joints, mass, effort, velocity, lower, upper):
    robot = rt.load(name)
    assert robot.joint_names == robot.actuated == joints
    np.testing.assert_array_equal(robot.limits.effort, effort)
    np.testing.assert_array_equal(robot.limits.velocity, velocity)
    np.testing.assert_array_equal(robot.limits.position_lower, lower)
    np.testing.assert_array_equal(robot.limits.position_upper, upper)
    assert robot.limits.warnings(robot.actuated) == ()
    assert sum(inertia.mass for inertia in robot.model.inertias) == pytest.approx(mass)


@pytest.mark.parametrize("name", FEET)
def test_every_link_has_an_inertia_that_a_body_can_have(name):
    for inertial in ElementTree.parse(folder() / name / f"{name}.urdf").iter("inertial"):
        entries = inertial.find("inertia").attrib
        x, y, z = sorted(float(entries[axis]) for axis in ("ixx", "iyy", "izz"))
        assert float(inertial.find("mass").get("value")) > 0
        assert x >= 0 and z <= x + y


@pytest.mark.parametrize("name", FEET)
def test_a_ball_under_every_foot_touches_the_ground_where_the_foot_is(name):
    robot = rt.load(name)
    data, shapes = robot.model.createData(), robot.collision_model
    places = shapes.createData()
    pin.updateGeometryPlacements(robot.model, data, shapes, places, robot.neutral)
    pin.updateFramePlacements(robot.model, data)
    bottoms = [
        place.translation - [0, 0, shape.geometry.radius]
        for shape, place in zip(shapes.geometryObjects, places.oMg, strict=True)
        if type(shape.geometry).__name__ == "Sphere"
    ]
    for foot in FEET[name]:
        touching = np.linalg.norm(np.array(bottoms) - data.oMf[robot.frame(foot)].translation, axis=1)
        assert touching.min() < 1e-12
