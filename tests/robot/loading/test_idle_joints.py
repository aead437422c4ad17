"""Joints of free roots that move no mass are locked, so that the mass matrix is regular."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.coupling.dynamics import mass_matrix


def body_with_a_head(head: np.ndarray, mass: float = 1.0) -> pin.Model:
    """A trunk with a leg and a head on crossing axes, of the given mass and inertia; no mass moves with an antenna."""
    model = pin.Model()
    trunk = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "leg")
    model.appendBodyToJoint(trunk, pin.Inertia(3.0, np.array([0.0, 0.0, 0.1]), 0.1 * np.eye(3)), pin.SE3.Identity())
    parent = 0
    for name, joint in (("pitch", pin.JointModelRY()), ("roll", pin.JointModelRX()), ("yaw", pin.JointModelRZ())):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), name)
    model.appendBodyToJoint(parent, pin.Inertia(mass, np.array([0.1, 0.0, 0.2]), head), pin.SE3.Identity())
    model.addJoint(parent, pin.JointModelRX(), pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.3])), "antenna")
    for joint in range(1, model.njoints):
        model.addJointFrame(joint)
    model.inertias[0] = pin.Inertia(5.0, np.zeros(3), 0.2 * np.eye(3))
    big = 10.0 * np.ones(model.nv)
    model.lowerPositionLimit, model.upperPositionLimit = -big, big
    return model


def load(model: pin.Model, **more: Any) -> rt.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return rt.load(model, **more)


def smallest(robot: rt.Robot) -> float:
    mass = mass_matrix(robot.model, robot.model.createData(), robot.neutral)[6:, 6:]
    sizes = np.sqrt(np.diag(mass))
    return float(np.linalg.eigvalsh(mass / np.outer(sizes, sizes)).min())


def test_one_joint_of_those_that_turn_together_and_one_alone_are_locked() -> None:
    robot = load(body_with_a_head(np.zeros((3, 3))), root="floating")
    assert set(robot.joint_names) >= {"leg", "pitch", "roll"} and not {"yaw", "antenna"} & set(robot.joint_names)
    assert smallest(robot) > 1e-4
    (note,) = (note for note in robot.notes if "move no mass" in note)
    assert "yaw at 0" in note and "antenna at 0" in note


def test_a_head_with_inertia_keeps_its_joints() -> None:
    robot = load(body_with_a_head(0.01 * np.eye(3)), root="floating")
    assert "yaw" in robot.joint_names and "antenna" not in robot.joint_names


@pytest.mark.parametrize("named", [{"actuated": ["leg", "antenna"]}, {"limits": {"effort": {"antenna": 3.0}}}])
def test_joints_that_the_caller_names_stay_and_are_refused_by_a_phase(named: dict[str, Any]) -> None:
    robot = load(body_with_a_head(0.01 * np.eye(3)), root="floating", **named)
    assert "antenna" in robot.joint_names
    with pytest.raises(rt.InputError, match="no mass moves with 'antenna'"):
        rt.Phase(robot, 1.0)


def test_a_fixed_robot_keeps_its_joints_which_kinematics_can_move() -> None:
    assert "antenna" in load(body_with_a_head(0.01 * np.eye(3))).joint_names


def test_loading_warns_of_them() -> None:
    with pytest.warns(UserWarning, match="move no mass, alone or together, are locked: antenna at 0"):
        rt.load(body_with_a_head(0.01 * np.eye(3)), root="floating")


def test_icub_walks_by_the_default_call() -> None:
    robot = rt.load("icub", root="floating")
    assert "neck_yaw" not in robot.joint_names and smallest(robot) > 1e-6
    rt.gait.walk(robot, step_length=0.1, duration=0.6)
