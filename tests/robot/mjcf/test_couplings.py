"""Joints of an MJCF that an equality ties to another one have no position of their own, and move as in MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.coupling.dynamics import mass_matrix

HAND = """<mujoco model="hand"><compiler angle="radian"/><worldbody><body name="palm" pos="0 0 0.1">
<joint name="lift" type="slide" axis="0 0 1" range="0 0.3" ref="0.1"/>
<inertial pos="0 0 0.02" mass="0.6" diaginertia="0.001 0.002 0.001"/>
<body name="inner" pos="0 0.05 0"><joint name="inner" axis="1 0 0" range="-1 1" damping="0.05"/>
<inertial pos="0 0 0.04" mass="0.1" diaginertia="1e-4 1e-4 5e-5"/><geom type="sphere" size="0.01" pos="0 0 0.04"/>
<body name="outer" pos="0 0 0.08"><joint name="outer" axis="1 0 0" range="-1 1" armature="1e-3" ref="0.3"/>
<inertial pos="0 0 0.03" mass="0.05" diaginertia="4e-5 4e-5 2e-5"/><geom type="sphere" size="0.01" pos="0 0 0.03"/>
</body></body></body></worldbody><equality>{equality}</equality>
<actuator><motor joint="lift" ctrlrange="-30 30"/>
<motor joint="outer" ctrlrange="-1 2" gear="2"/></actuator></mujoco>"""
LINE = '<joint joint1="outer" joint2="inner" polycoef="0.1 -0.5 0 0 0"/>'
TURNED = '<joint joint1="inner" joint2="outer" polycoef="0.2 -2 0 0 0"/>'


@pytest.mark.parametrize("equality", [LINE, TURNED])
def test_dynamics_are_those_of_mujoco_on_the_equality(tmp_path, equality):
    """With q = (lift, s, 0.4 - s / 2) and G = dq / ds, the mass matrix is G' M G and the weight G' g."""
    path = tmp_path / "hand.xml"
    path.write_text(HAND.format(equality=equality), encoding="utf-8")
    robot = rt.load(path)
    assert robot.joint_names == ("lift", "inner")
    assert robot.actuated == ("lift", "inner")
    np.testing.assert_allclose([side[1] for side in robot.limits.sides("effort")], [-2.0, 1.0])
    theirs = mujoco.MjModel.from_xml_path(str(path))
    data, there = robot.model.createData(), mujoco.MjData(theirs)
    random, line = np.random.default_rng(0), np.array([[1.0, 0.0], [0.0, 1.0], [0.0, -0.5]])
    for _ in range(3):
        q = random.uniform(-0.4, 0.4, 2)
        there.qpos[:] = line @ q + [0.0, 0.0, 0.4]
        mujoco.mj_forward(theirs, there)
        full = np.zeros((3, 3))
        for column, unit in zip(full, np.eye(3), strict=True):
            mujoco.mj_mulM(theirs, there, column, unit)
        np.testing.assert_allclose(mass_matrix(robot.model, data, q), line.T @ full @ line, atol=1e-12)
        pin.framesForwardKinematics(robot.model, data, q)
        tip = data.oMf[robot.frame("outer")].translation
        np.testing.assert_allclose(tip, there.body("outer").xpos, atol=1e-12)
        still = np.zeros(2)
        np.testing.assert_allclose(pin.rnea(robot.model, data, q, still, still), line.T @ there.qfrc_bias, atol=1e-12)


def test_coupled_joints_plan_and_are_proved(tmp_path):
    path = tmp_path / "hand.xml"
    path.write_text(HAND.format(equality=LINE), encoding="utf-8")
    robot = rt.load(path)
    ends = rt.State(q=[0.05, -0.4], v=0), rt.State(q=[0.1, 0.5], v=0)
    solution = rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort()), progress=False)
    assert solution.proved
    assert rt.validate(solution).passed


@pytest.mark.parametrize(
    "equality",
    [
        LINE.replace("0 0 0", "0.1 0 0"),
        LINE.replace('joint2="inner"', ""),
        LINE + LINE.replace('joint2="inner"', 'joint2="lift"'),
        '<connect body1="outer" body2="palm" anchor="0 0 0"/>',
    ],
)
def test_equalities_of_other_kinds_are_named(tmp_path, equality):
    path = tmp_path / "hand.xml"
    path.write_text(HAND.format(equality=equality), encoding="utf-8")
    with pytest.warns(UserWarning, match="Sections of the MJCF that are not read: <equality>"):
        rt.load(path)


def test_an_equality_that_is_off_does_not_hold(tmp_path):
    path = tmp_path / "hand.xml"
    path.write_text(HAND.format(equality=LINE.replace("<joint", '<joint active="false"')), encoding="utf-8")
    assert rt.load(path).nv == 3
