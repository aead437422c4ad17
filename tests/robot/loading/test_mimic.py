"""Joints coupled by <mimic> are locked together, each where its leader puts it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


def gripper(urdf, follow='<mimic joint="finger" multiplier="-2" offset="0.3"/>'):
    return urdf.chain(
        ("arm", "revolute", "0 0 1"),
        ("finger", "revolute", "0 1 0"),
        ("thumb", "revolute", "0 1 0", LIMIT + follow),
    )


def placement_of(path, robot, locked):
    """Where the last link is, in the robot and in Pinocchio's model of the whole URDF."""
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    q = np.array([locked.get(name, 0.2) for name in list(model.names)[1:]])
    pin.framesForwardKinematics(model, data, q)
    mine = robot.model.createData()
    pin.framesForwardKinematics(robot.model, mine, np.array([0.2]))
    return data.oMf[model.getFrameId("link3")].homogeneous, mine.oMf[robot.frame("link3")].homogeneous


def test_leader_and_follower_are_locked_at_the_leaders_neutral_position(urdf):
    path = gripper(urdf)
    robot = rt.load(path)
    assert robot.joint_names == ("arm",)
    expected, got = placement_of(path, robot, {"finger": 0.0, "thumb": 0.3})
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_a_locked_leader_takes_its_followers_along(urdf):
    path = gripper(urdf)
    robot = rt.load(path, locked={"finger": 0.5})
    expected, got = placement_of(path, robot, {"finger": 0.5, "thumb": -0.7})
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_a_follower_may_be_locked_where_its_leader_puts_it_and_nowhere_else(urdf):
    path = gripper(urdf)
    assert rt.load(path, locked={"thumb": 0.3}).nq == 1
    with pytest.raises(rt.InputError, match=r"'thumb' at 1, but it mimics 'finger', which puts it at 0.3"):
        rt.load(path, locked={"thumb": 1.0})


def test_the_notes_of_a_robot_list_locked_joints(urdf):
    assert any("finger at 0, thumb at 0.3" in note for note in rt.load(gripper(urdf)).notes)


def test_pandas_fingers_are_locked_and_its_arm_moves():
    robot = rt.load("panda")
    assert robot.joint_names == tuple(f"panda_joint{i}" for i in range(1, 8))
    wide = rt.load("panda", locked={"panda_finger_joint1": 0.03})
    data = wide.model.createData()
    pin.framesForwardKinematics(wide.model, data, wide.neutral)
    left, right = (data.oMf[wide.frame(name)].translation for name in ("panda_leftfinger", "panda_rightfinger"))
    assert np.linalg.norm(left - right) == pytest.approx(0.06, abs=1e-12)


def test_independent_joints_come_from_a_model():
    model = pin.buildModelFromUrdf(str(find("panda").urdf))
    assert rt.load(model).nq == 9


def test_active_mimic_joints_of_a_model_are_refused():
    model = pin.buildModelFromUrdf(str(find("panda").urdf), True)
    with pytest.raises(rt.InputError, match="active mimic joints .panda_finger_joint2.*mimic=False"):
        rt.load(model)


@pytest.mark.parametrize(
    ("follow", "part"),
    [
        ('<mimic joint="thumb"/>', "cycle"),
        ('<mimic joint="nose"/>', "'thumb' mimics 'nose'"),
        ('<mimic joint="finger" multiplier="two"/>', "'thumb' has <mimic multiplier='two'>"),
    ],
)
def test_couplings_that_cannot_be(urdf, follow, part):
    with pytest.raises(rt.InputError, match=part):
        rt.load(gripper(urdf, follow))


def test_a_robot_of_coupled_joints_alone_cannot_move(urdf):
    path = urdf.chain(("a", "revolute", "0 0 1"), ("b", "revolute", "0 0 1", LIMIT + '<mimic joint="a"/>'))
    with pytest.raises(rt.InputError, match=r"Every joint .* is locked \(a, b\).*mimic=False"):
        rt.load(path)
