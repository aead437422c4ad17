"""Models of MuJoCo have the masses, motors and limits of their file, and plan."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trimesh

import robotraj as rt

ARM = """<mujoco model="arm"><compiler angle="radian" meshdir="meshes"/>{asset}
<default><joint damping="0.5" armature="0.02"/></default>
<worldbody><body name="upper" pos="0 0 0.2">
<joint name="shoulder" type="hinge" axis="0 1 0" range="-2 2"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.4" mass="1"/>
<body name="fore" pos="0 0 0.4"><joint name="elbow" type="hinge" axis="0 1 0" range="-2 2" frictionloss="0.1"/>
<inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.002"/>{geom}
<body name="ram"><joint name="slide" type="slide" axis="0 0 1" range="0 0.1"/>
<geom type="sphere" size="0.03" mass="0.2"/></body>
</body></body></worldbody>
<actuator><motor joint="shoulder" ctrlrange="-3 2" gear="10"/>
<position joint="slide" kp="9" forcerange="-15 15"/></actuator>{more}</mujoco>"""
BOX = '<geom type="box" size="0.02 0.02 0.1"/>'


def write(folder, asset="", geom=BOX, more=""):
    path = folder / "arm.xml"
    path.write_text(ARM.format(asset=asset, geom=geom, more=more), encoding="utf-8")
    return path


def test_masses_motors_and_limits_are_those_of_the_file(tmp_path):
    robot = rt.load(write(tmp_path))
    assert robot.joint_names == ("shoulder", "elbow", "slide")
    assert robot.actuated == ("shoulder", "slide")
    np.testing.assert_array_equal(robot.limits.sides("position"), [[-2, -2, 0], [2, 2, 0.1]])
    np.testing.assert_array_equal(robot.limits.sides("effort"), [[-30, -np.inf, -15], [20, np.inf, 15]])
    np.testing.assert_array_equal(robot.damping, [0.5, 0.5, 0.5])
    np.testing.assert_array_equal(robot.friction, [0, 0.1, 0])
    assert robot.collision_model.ngeoms == 3


def test_accelerations_are_those_of_mujoco(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    path = write(tmp_path)
    robot, model = rt.load(path), mujoco.MjModel.from_xml_path(str(path))
    flags = mujoco.mjtDisableBit
    model.opt.disableflags |= flags.mjDSBL_CONSTRAINT | flags.mjDSBL_ACTUATION
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(5):
        q, v, tau = rng.uniform(-1.0, 1.0, (3, 3))
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, v, tau
        mujoco.mj_forward(model, data)
        own = pin.aba(robot.model, robot.model.createData(), q, v, tau - robot.damping * v)
        np.testing.assert_allclose(own, data.qacc, rtol=1e-8, atol=1e-8)


def test_it_plans_and_is_proved(tmp_path):
    robot = rt.load(write(tmp_path), actuated=["shoulder", "elbow", "slide"])
    ends = rt.State(q=[0.0, 0.5, 0.05], v=0), rt.State(q=[1.0, -0.5, 0.02], v=0)
    solution = rt.plan(rt.Phase(robot, 2.0, *ends, rt.Effort()), progress=False)
    assert solution.proof.motion_holds


def test_meshes_are_read_within_limits(tmp_path):
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "meshes" / "box.stl")
    asset, geom = '<asset><mesh name="box" file="box.stl"/></asset>', '<geom type="mesh" mesh="box"/>'
    assert rt.load(write(tmp_path, asset, geom)).collision_model.ngeoms == 3
    (tmp_path / "meshes" / "box.stl").write_bytes(b"no mesh")
    with pytest.raises(rt.InputError, match=r"the mesh .*box.stl' cannot be read"):
        rt.load(write(tmp_path, asset, geom))


def test_meshes_outside_the_folder_are_read_when_trusted_alone(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "box.stl")
    asset, geom = '<asset><mesh name="box" file="../../box.stl"/></asset>', '<geom type="mesh" mesh="box"/>'
    (inner / "meshes").mkdir()
    path = write(inner, asset, geom)
    with pytest.raises(rt.InputError, match="lies outside the folder of the file"):
        rt.load(path)
    assert rt.load(path, trust_paths=True).collision_model.ngeoms == 3
    assert rt.load(path, package_dirs=tmp_path).collision_model.ngeoms == 3


def test_what_is_not_read_is_named(tmp_path):
    tied = '<equality><joint joint1="shoulder" joint2="elbow"/></equality>'
    with pytest.warns(UserWarning, match="Sections of the MJCF that are not read: <equality>"):
        rt.load(write(tmp_path, more=tied))
    with pytest.raises(rt.InputError, match="includes other files"):
        rt.load(write(tmp_path, more='<include file="other.xml"/>'))
    with pytest.raises(rt.InputError, match="Pinocchio cannot read the MJCF"):
        rt.load(write(tmp_path, geom='<geom type="box" size="a b c"/><joint type="screw"/>'))
