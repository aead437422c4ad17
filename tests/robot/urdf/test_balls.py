"""A ball joint of a URDF moves as that of a model: its chain of hinges has the same kinetic energy and places."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

BODY = (
    '<inertial><origin xyz="0.1 0 -0.2"/><mass value="2"/><inertia ixx=".1" iyy=".2" izz=".15" ixy=".01" ixz="0" '
    'iyz="0"/></inertial><collision><geometry><sphere radius="0.05"/></geometry></collision>'
)
ARM = (
    f'<robot name="arm"><link name="base"/><link name="upper">{BODY}</link><link name="fore">{BODY}</link>'
    '<joint name="shoulder" type="TYPE"><origin xyz="0 0 1" rpy="0.3 0 0"/><parent link="base"/><child link="upper"/>'
    '<limit effort="9" velocity="2"/></joint>'
    '<joint name="elbow" type="revolute"><origin xyz="0 0 -0.4"/><parent link="upper"/><child link="fore"/>'
    '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="2"/></joint></robot>'
)


@pytest.mark.parametrize("kind", ["spherical", "ball"])
def test_a_chain_of_hinges_equals_a_ball_joint(kind, urdf):
    robot = rt.load(urdf.text(ARM.replace("TYPE", kind)))
    assert robot.velocity_names == ("shoulder_yaw", "shoulder_pitch", "shoulder_roll", "elbow")
    np.testing.assert_array_equal(robot.limits.effort, 9.0)
    ball = pin.Model()
    place = pin.SE3(pin.rpy.rpyToMatrix(0.3, 0.0, 0.0), np.array([0.0, 0.0, 1.0]))
    shoulder = ball.addJoint(0, pin.JointModelSpherical(), place, "shoulder")
    elbow = ball.addJoint(shoulder, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.4])), "elbow")
    body = pin.Inertia(
        2.0, np.array([0.1, 0.0, -0.2]), np.array([[0.1, 0.01, 0.0], [0.01, 0.2, 0.0], [0.0, 0.0, 0.15]])
    )
    for joint in (shoulder, elbow):
        ball.appendBodyToJoint(joint, body, pin.SE3.Identity())
    assert [shape.name for shape in robot.collision_model.geometryObjects] == ["upper_0", "fore_0"]
    random = np.random.default_rng(0)
    data, own = ball.createData(), robot.model.createData()
    for _ in range(5):
        q, v, step = random.uniform(-1, 1, 4), random.normal(size=4), 1e-6
        turned = [pin.Quaternion(pin.rpy.rpyToMatrix(*(q + s * v)[2::-1])).coeffs() for s in (0.0, step)]
        speed = pin.difference(ball, np.r_[turned[0], q[3]], np.r_[turned[1], q[3] + step * v[3]]) / step
        exact = pin.computeKineticEnergy(ball, data, np.r_[turned[0], q[3]], speed)
        assert pin.computeKineticEnergy(robot.model, own, q, v) == pytest.approx(exact, rel=1e-5)
        heights = [
            pin.computePotentialEnergy(*each) for each in ((ball, data, np.r_[turned[0], q[3]]), (robot.model, own, q))
        ]
        assert heights[1] == pytest.approx(heights[0], rel=1e-12)
