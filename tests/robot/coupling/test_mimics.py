"""Couplings are read, resolved to independent leaders, and locked together."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.coupling.mimics import Mimic, lock_mimics, mimics_of, resolved
from robotraj.robot.known_robots.catalogue import find

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


def gripper(urdf, follow='<mimic joint="finger" multiplier="-2" offset="0.3"/>'):
    return urdf.chain(
        ("arm", "revolute", "0 0 1"),
        ("finger", "revolute", "0 1 0"),
        ("thumb", "revolute", "0 1 0", LIMIT + follow),
    )


def placement_of(path, robot, joints, q):
    """Where the last link is, in the robot at q and in Pinocchio's model of the whole URDF at the joints' places."""
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.array([joints[name] for name in list(model.names)[1:]]))
    mine = robot.model.createData()
    pin.framesForwardKinematics(robot.model, mine, np.array(q))
    return data.oMf[model.getFrameId("link3")].homogeneous, mine.oMf[robot.frame("link3")].homogeneous


def test_a_follower_has_no_entry_in_q_and_moves_with_its_leader(urdf):
    path = gripper(urdf)
    robot = rt.load(path)
    assert robot.joint_names == robot.velocity_names == ("arm", "finger")
    assert robot.actuated == ("arm", "finger")
    assert robot.followers == (Mimic("thumb", "finger", -2.0, 0.3),)
    expected, got = placement_of(path, robot, {"arm": 0.2, "finger": 0.4, "thumb": -0.5}, [0.2, 0.4])
    np.testing.assert_allclose(got, expected, atol=1e-12)
    assert any("thumb = -2 finger + 0.3" in note for note in robot.notes)


def test_a_chain_of_couplings_is_one_coupling_to_its_head():
    chain = (Mimic("c", "b", 2.0, 0.5), Mimic("b", "a", -3.0, 0.1))
    assert resolved(chain) == (Mimic("c", "a", -6.0, 0.7), Mimic("b", "a", -3.0, 0.1))


def test_a_locked_leader_takes_its_followers_along(urdf):
    path = gripper(urdf)
    robot = rt.load(path, locked={"finger": 0.5})
    assert robot.joint_names == ("arm",)
    expected, got = placement_of(path, robot, {"arm": 0.2, "finger": 0.5, "thumb": -0.7}, [0.2])
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_a_locked_follower_locks_its_leader_and_the_others():
    mimics = (Mimic("thumb", "finger", -2.0, 0.3), Mimic("ring", "finger", 1.0, 0.0))
    assert lock_mimics(mimics, {"thumb": -0.7}) == pytest.approx({"thumb": -0.7, "finger": 0.5, "ring": 0.5})
    with pytest.raises(rt.InputError, match=r"'ring' at 1, but it mimics 'finger', which puts it at 0.5"):
        lock_mimics(mimics, {"thumb": -0.7, "ring": 1.0})


def test_a_multiplier_of_0_is_a_joint_at_rest(urdf):
    robot = rt.load(gripper(urdf, '<mimic joint="finger" multiplier="0" offset="0.3"/>'))
    assert robot.joint_names == ("arm", "finger") and not robot.followers


def test_pandas_fingers_are_locked_by_name_and_move_by_path():
    robot = rt.load("panda")
    assert robot.joint_names == tuple(f"panda_joint{i}" for i in range(1, 8))
    assert any("panda_finger_joint1 at 0" in note for note in robot.notes)
    wide = rt.load("panda", locked={"panda_finger_joint2": 0.03})
    moving = rt.load(find("panda").urdf)
    assert moving.joint_names[7:] == ("panda_finger_joint1",)
    for each, q in ((wide, wide.neutral), (moving, np.append(wide.neutral, 0.03))):
        data = each.model.createData()
        pin.framesForwardKinematics(each.model, data, q)
        left, right = (data.oMf[each.frame(name)].translation for name in ("panda_leftfinger", "panda_rightfinger"))
        assert np.linalg.norm(left - right) == pytest.approx(0.06, abs=1e-12)


def test_independent_joints_come_from_a_model():
    assert rt.load(pin.buildModelFromUrdf(str(find("panda").urdf))).nq == 9


def test_active_mimic_joints_of_a_model_are_its_couplings():
    model = pin.buildModelFromUrdf(str(find("panda").urdf), True)
    robot = rt.load(model)
    assert robot.followers == mimics_of(model) == (Mimic("panda_finger_joint2", "panda_finger_joint1", 1.0, 0.0),)


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


def test_a_robot_of_coupled_joints_alone_moves_by_its_leader(urdf):
    path = urdf.chain(("a", "revolute", "0 0 1"), ("b", "revolute", "0 0 1", LIMIT + '<mimic joint="a"/>'))
    assert rt.load(path).joint_names == ("a",)
    with pytest.raises(rt.InputError, match=r"Every joint .* is locked \(a, b\).*coupled|couples"):
        rt.load(path, locked={"b": 0.1})


def test_a_motor_belongs_to_the_leader(urdf):
    with pytest.raises(rt.InputError, match="'thumb', which moves with 'finger'.*Name the leader"):
        rt.load(gripper(urdf), actuated=["arm", "thumb"])
