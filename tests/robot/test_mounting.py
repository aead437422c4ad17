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
        ({"base": ((0, 0, np.nan), (0, 0, 0, 1))}, "three finite numbers"),
        ({"rotors": {"elbow": (1e-5, 100)}}, "elbow_joint"),
        ({"rotors": {"elbow_joint": 3}}, "gear ratio"),
    ],
)
def test_what_is_no_mounting_is_refused(options, words):
    with pytest.raises(rt.InputError, match=words):
        rt.load("ur5", **options)


def test_a_base_under_a_moving_root_turns_the_robot_and_its_shapes_in_that_root():
    pose = pin.SE3(pin.rpy.rpyToMatrix(np.pi / 2, 0.0, 0.3), np.array([0.1, -0.2, 0.3]))
    plain, turned = rt.load("ur5", root="floating"), rt.load("ur5", root="floating", base=pose)
    q = np.concatenate([np.zeros(6), [1.0], Q])
    placed, shapes = [], []
    for robot in (plain, turned):
        data, geometry = robot.model.createData(), robot.collision_model
        pin.framesForwardKinematics(robot.model, data, q)
        placed.append([data.oMf[robot.frame(name)] for name in ("base_link", "tool0")])
        where = geometry.createData()
        pin.updateGeometryPlacements(robot.model, data, geometry, where)
        shapes.append([where.oMg[i] for i in range(len(geometry.geometryObjects))])
    assert len(shapes[0]) > 5
    for here, there in zip(placed[0] + shapes[0], placed[1] + shapes[1], strict=True):
        assert np.allclose((pose * here).homogeneous, there.homogeneous, atol=1e-12)
    # The same motion of the world's axes has the same energy: a root twist x moves the turned root by Ad(pose) x.
    masses = [pin.crba(each.model, each.model.createData(), q) for each in (plain, turned)]
    twist = np.arange(1.0, 7.0)
    energies = [
        np.concatenate([x, np.zeros(6)]) @ (np.triu(m) + np.triu(m, 1).T) @ np.concatenate([x, np.zeros(6)])
        for x, m in zip((twist, pose.action @ twist), masses, strict=True)
    ]
    assert energies[0] == pytest.approx(energies[1], rel=1e-12)


def test_a_base_of_a_model_with_a_free_flyer_turns_the_robot_in_it():
    pose = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, np.pi / 2), np.zeros(3))
    plain = rt.load("solo12", root="floating")
    turned = rt.load(plain.model, root="floating", base=pose)
    q, placed = pin.neutral(plain.model), []
    for robot in (plain, turned):
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, q)
        placed.append(data.oMf[robot.frame("FL_FOOT")].homogeneous)
    assert np.allclose(pose.homogeneous @ placed[0], placed[1], atol=1e-12)
