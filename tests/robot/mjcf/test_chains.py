"""Bodies with several joints move as in MuJoCo, and keep the names of their joints."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

JOINTS = (
    '<joint name="b" axis="0 1 0" range="-1 1" damping="0.3"/><joint name="c" axis="1 0 0" pos="0 0 0.05" '
    'range="-1.5 1" armature="0.2"/><joint name="d" type="slide" axis="1 0 0" range="0 0.1"/>'
)
ARM = (
    '<mujoco model="arm"><compiler angle="radian" autolimits="true"/><worldbody><body name="lower">{free}'
    '<joint name="a" axis="0 0 1"/><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>'
    '<body name="upper" pos="0 0 0.3">{joints}<geom type="box" size="0.02 0.03 0.1" pos="0 0 0.2" mass="0"/>'
    '<inertial pos="0 0 0.15" mass="0.8" diaginertia="0.008 0.009 0.002"/></body></body></worldbody>'
    "{motors}</mujoco>"
)
MOTORS = '<actuator><motor joint="c" ctrlrange="-30 20"/></actuator>'


def load(folder, joints=JOINTS, free=False, **options):
    motors = MOTORS if '"c"' in joints else ""
    text = ARM.format(joints=joints, free="<freejoint/>" if free else "", motors=motors)
    text = text.replace('<joint name="a" axis="0 0 1"/>', "") if free else text
    (folder / "arm.xml").write_text(text, encoding="utf-8")
    return rt.load(folder / "arm.xml", **options)


def test_three_joints_of_a_body_keep_their_names_limits_and_motors(tmp_path):
    robot = load(tmp_path)
    assert robot.joint_names == ("a", "b", "c", "d") and robot.actuated == ("c",)
    np.testing.assert_array_equal(robot.limits.sides("position"), [[-np.inf, -1, -1.5, 0], [np.inf, 1, 1, 0.1]])
    np.testing.assert_array_equal([side[2] for side in robot.limits.sides("effort")], [-30, 20])
    np.testing.assert_array_equal(robot.damping, [0, 0.3, 0, 0])


def test_accelerations_and_shapes_are_those_of_mujoco(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    robot, model = load(tmp_path), mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(5):
        q, v, tau = rng.uniform(-0.5, 0.5, (3, 4))
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, v, tau
        mujoco.mj_forward(model, data)
        own = robot.model.createData()
        a = pin.aba(robot.model, own, q, v, tau - robot.damping * v)
        np.testing.assert_allclose(a, data.qacc, rtol=1e-9, atol=1e-9)
        places = robot.collision_model.createData()
        pin.updateGeometryPlacements(robot.model, own, robot.collision_model, places, q)
        np.testing.assert_allclose(places.oMg[0].translation, data.geom_xpos[0], atol=1e-12)


def test_a_floating_body_carries_one_with_several_joints(tmp_path):
    robot = load(tmp_path, free=True, root="floating")
    assert robot.joint_names[-3:] == ("b", "c", "d") and robot.nq == 10


def test_a_ball_is_three_turns(tmp_path):
    robot = load(tmp_path, joints='<joint name="b" type="ball"/>')
    assert robot.joint_names == ("a", "b_yaw", "b_pitch", "b_roll")


@pytest.mark.parametrize(("axes", "driven"), [("xyz", ("a", "b_yaw", "b_pitch", "b_roll")), ("xy", ("a",))])
def test_motors_about_three_axes_of_a_ball_drive_it_and_fewer_are_named(tmp_path, axes, driven):
    gears = {"x": "5 0 0", "y": "0 5 0", "z": "0 0 5"}
    motors = "".join(f'<motor name="{axis}" joint="b" gear="{gears[axis]}" ctrlrange="-1 1"/>' for axis in axes)
    motors = f'<actuator><motor joint="a" ctrlrange="-9 9"/>{motors}</actuator>'
    (tmp_path / "arm.xml").write_text(ARM.format(joints='<joint name="b" type="ball"/>', free="", motors=motors))
    unread = "without a limit of effort.*'b_yaw', 'b_pitch', 'b_roll'" if len(axes) == 3 else "not read: x, y"
    with pytest.warns(UserWarning, match=unread):
        robot = rt.load(tmp_path / "arm.xml")
    assert robot.actuated == driven
