"""The robots that ship with robotraj satisfy their textbook equations and name their sources."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import folder, own_robots

NAMES = ("acrobot", "block", "cartpole", "pendulum", "two_link_arm")
LEGGED = ("compass_walker", "five_link", "five_link_table", "hopper", "monopod")
G = 9.81
SAMPLES = 50


def block(q, v, tau):
    return [tau[0] / 1.0]


def pendulum(q, v, tau):
    return [-0.1 * v[0] - 1.0 * np.sin(q[0]) + tau[0]]


def cartpole(q, v, tau):
    m1, m2, length, u = 1.0, 0.3, 0.5, tau[0]
    s, c, w = np.sin(q[1]), np.cos(q[1]), v[1]
    below = m1 + m2 * s**2
    return [
        (u + G * m2 * c * s + length * m2 * s * w**2) / below,
        -(u * c + (m1 + m2) * G * s + length * m2 * c * s * w**2) / (length * below),
    ]


def acrobot(q, v, tau):
    """Absolute angles q1 = shoulder, q2 = shoulder + elbow; the elbow torque acts between the links."""
    m1 = m2 = 1.0
    l1 = l2 = 0.5
    q1, q2, w1, w2, u = q[0], q[0] + q[1], v[0], v[0] + v[1], tau[0]
    coupling = m2 * l1 * l2 * np.cos(q1 - q2)
    mass = np.array([[(m1 + m2) * l1**2, coupling], [coupling, m2 * l2**2]])
    swing = m2 * l1 * l2 * np.sin(q1 - q2)
    right = [
        -swing * w2**2 - (m1 + m2) * G * l1 * np.sin(q1) - u,
        swing * w1**2 - m2 * G * l2 * np.sin(q2) + u,
    ]
    absolute = np.linalg.solve(mass, right)
    return [absolute[0], absolute[1] - absolute[0]]


def two_link_arm(q, v, tau):
    """x1, x2 are the links' absolute speeds, x3 is the elbow, x4 the shoulder."""
    x1, x2, x3, (u1, u2) = v[0], v[0] + v[1], q[1], tau
    s, c = np.sin(x3), np.cos(x3)
    below = 31 / 36 + 9 / 4 * s**2
    rate1 = (s * (9 / 4 * c * x1**2 + 2 * x2**2) + 4 / 3 * (u1 - u2) - 3 / 2 * c * u2) / below
    rate2 = -(s * (7 / 2 * x1**2 + 9 / 4 * c * x2**2) - 7 / 3 * u2 + 3 / 2 * c * (u1 - u2)) / below
    return [rate1, rate2 - rate1]


FORMULAS = {
    "block": block,
    "pendulum": pendulum,
    "cartpole": cartpole,
    "acrobot": acrobot,
    "two_link_arm": two_link_arm,
}


@pytest.mark.parametrize("name", NAMES)
def test_accelerations_equal_the_formula(name):
    robot = rt.load(name)
    data = robot.model.createData()
    rng = np.random.default_rng(7)
    for _ in range(SAMPLES):
        q = rng.uniform(-3, 3, robot.nq)
        v = rng.uniform(-2, 2, robot.nv)
        tau = rng.uniform(-5, 5, robot.nu)
        a = pin.aba(robot.model, data, q, v, robot.actuation @ tau - robot.dissipation(v))
        expected = np.array(FORMULAS[name](q, v, tau))
        np.testing.assert_allclose(a, expected, rtol=1e-12, atol=1e-12 * max(1.0, np.abs(expected).max()))


def test_these_robots_and_no_others_ship():
    assert sorted(own_robots()) == sorted(NAMES + LEGGED)


@pytest.mark.parametrize(
    ("name", "joints", "actuated", "effort", "lower", "upper"),
    [
        ("block", ("slider",), ("slider",), [1], [-20], [20]),
        ("pendulum", ("pivot",), ("pivot",), [5], [-2 * np.pi], [2 * np.pi]),
        ("cartpole", ("slider", "pole"), ("slider",), [20, 0], [-2, -2 * np.pi], [2, 2 * np.pi]),
        (
            "acrobot",
            ("shoulder", "elbow"),
            ("elbow",),
            [0, 20],
            [-2 * np.pi, -4 * np.pi],
            [2 * np.pi, 4 * np.pi],
        ),
        ("two_link_arm", ("shoulder", "elbow"), ("shoulder", "elbow"), [1, 1], [-2, -2], [2, 2]),
    ],
)
def test_joints_motors_and_limits(name, joints, actuated, effort, lower, upper):
    robot = rt.load(name)
    assert robot.joint_names == joints
    assert robot.actuated == actuated
    np.testing.assert_array_equal(robot.limits.effort, effort)
    np.testing.assert_array_equal(robot.limits.position_lower, lower)
    np.testing.assert_array_equal(robot.limits.position_upper, upper)
    assert robot.limits.warnings(robot.actuated) == ()
    np.testing.assert_array_equal(robot.neutral, np.zeros(robot.nq))


@pytest.mark.parametrize("name", NAMES + LEGGED)
def test_every_robot_has_shapes_colours_and_an_end_effector(name):
    robot = rt.load(name)
    shapes = robot.visual_model.geometryObjects
    assert {shape.parentJoint for shape in shapes} == set(range(robot.model.njoints))
    assert all(shape.meshColor[3] == 1.0 for shape in shapes)
    assert len({tuple(shape.meshColor) for shape in shapes}) >= 3
    moving = {shape.parentJoint for shape in robot.collision_model.geometryObjects} - {0}
    assert moving == set(range(1, robot.model.njoints))
    assert robot.frame(robot.end_effector) > 0


@pytest.mark.parametrize(
    ("name", "hanging", "moved"),
    [
        ("pendulum", [0, 0, 0.2], [0.8, 0, 1.0]),
        ("cartpole", [0, 0, 0.3], [1.5, 0, 0.8]),
        ("acrobot", [0, 0, 0.2], [1.0, 0, 1.2]),
    ],
)
def test_a_positive_quarter_turn_takes_the_tip_from_below_to_plus_x(name, hanging, moved):
    robot = rt.load(name)
    turned = {"pendulum": [np.pi / 2], "cartpole": [1.0, np.pi / 2], "acrobot": [np.pi / 2, 0]}[name]
    data = robot.model.createData()
    for q, place in ((np.zeros(robot.nq), hanging), (np.array(turned), moved)):
        pin.framesForwardKinematics(robot.model, data, q)
        np.testing.assert_allclose(data.oMf[robot.frame("tip")].translation, place, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_no_pose_reaches_below_the_ground(name):
    robot = rt.load(name)
    data, shapes = robot.model.createData(), robot.visual_model
    places = shapes.createData()
    rng = np.random.default_rng(3)
    for _ in range(SAMPLES):
        q = rng.uniform(robot.limits.position_lower, robot.limits.position_upper)
        pin.updateGeometryPlacements(robot.model, data, shapes, places, q)
        for shape, place in zip(shapes.geometryObjects, places.oMg, strict=True):
            shape.geometry.computeLocalAABB()
            centre = place.act(np.array(shape.geometry.aabb_center))
            if shape.parentJoint:
                assert centre[2] > 0.1


@pytest.mark.parametrize("name", NAMES + LEGGED)
def test_licence_and_provenance_are_stated_and_no_mesh_is_needed(name):
    about = json.loads((folder() / name / "robot.json").read_text(encoding="utf-8"))
    assert about["licence"] == "CC0-1.0"
    assert len(about["provenance"]) > 40
    root = ElementTree.parse(folder() / name / f"{name}.urdf").getroot()
    assert root.get("name") == name
    assert root.findall(".//mesh") == []
    notice = (Path(folder()) / "NOTICE").read_text(encoding="utf-8")
    assert f"  {name} " in notice
