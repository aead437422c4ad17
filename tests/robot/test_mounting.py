"""Gravity, base and rotors of ``rt.load``: the same robot elsewhere."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

Q = np.array([0.3, -1.2, 1.1, -0.4, 0.5, 0.2])


def _gravity(robot):
    return pin.computeGeneralizedGravity(robot.model, robot.model.createData(), Q)


def test_a_base_moves_every_frame_and_turns_gravity():
    pose = pin.SE3(pin.rpy.rpyToMatrix(np.pi, 0.0, 0.4), np.array([0.5, -0.2, 1.8]))
    plain, hanging = rt.load("ur5"), rt.load("ur5", base=pose)
    for robot, quaternion in ((hanging, None), (plain, pin.Quaternion(pose.rotation).coeffs())):
        if quaternion is not None:
            robot = rt.load("ur5", base=(pose.translation, quaternion))
        placed = []
        for each in (robot, plain):
            data = each.model.createData()
            pin.framesForwardKinematics(each.model, data, Q)
            placed.append(data.oMf[each.frame("tool0")])
        assert np.allclose(placed[0].homogeneous, (pose * placed[1]).homogeneous, atol=1e-12)
    turned = rt.load("ur5", gravity=pose.rotation.T @ [0.0, 0.0, -9.81])
    assert np.allclose(_gravity(hanging), _gravity(turned), atol=1e-10)
    assert not np.allclose(_gravity(hanging), _gravity(plain), atol=1.0)
    assert len(hanging.visual_model.geometryObjects) == len(plain.visual_model.geometryObjects)


def test_without_gravity_no_torque_holds_the_arm():
    assert np.allclose(_gravity(rt.load("ur5", gravity=(0, 0, 0))), 0.0)


def test_a_rotor_adds_its_inertia_times_the_squared_ratio():
    plain, geared = rt.load("ur5"), rt.load("ur5", rotors={"elbow_joint": (1e-4, 100.0)})
    added = [pin.crba(each.model, each.model.createData(), Q).copy() for each in (geared, plain)]
    assert (added[0] - added[1])[2, 2] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"gravity": (0, 0)}, "three finite numbers"),
        ({"base": (0, 0, 1)}, "base="),
        ({"rotors": {"elbow": (1e-5, 100)}}, "elbow_joint"),
        ({"rotors": {"elbow_joint": 3}}, "gear ratio"),
    ],
)
def test_what_is_no_mounting_is_refused(options, words):
    with pytest.raises(rt.InputError, match=words):
        rt.load("ur5", **options)


def test_a_moving_root_has_no_base():
    with pytest.raises(rt.InputError, match="fixed root"):
        rt.load("ur5", root="floating", base=((0, 0, 0), (0, 0, 0, 1)))
