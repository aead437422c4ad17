"""Springs and motors of an MJCF file, with what its default classes state, act as in MuJoCo."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

TREE = """<mujoco model="sprung"><compiler{angle}/>
<default><joint damping="0.2" stiffness="3"/><motor gear="4" ctrlrange="-2 2"/>
<default class="leg"><joint stiffness="12" springref="{rest}"/><position forcerange="-7 6"/>
<default class="foot"><joint stiffness="0"/></default></default></default>
<worldbody><body name="a" pos="0 0 0.1"><joint name="a" axis="0 1 0"/><geom type="sphere" size="0.05" mass="1"/>
<body name="b" pos="0 0 0.3" childclass="leg"><joint name="b" axis="1 0 0"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.3" mass="0.7"/>
<body name="c" pos="0 0 0.3"><joint name="c" type="slide" axis="0 0 1"/><geom type="sphere" size="0.04" mass="0.4"/>
<body name="d" pos="0.1 0 0"><joint name="d" class="foot" axis="0 1 0"/><geom type="sphere" size="0.04" mass="0.3"/>
</body></body></body></body></worldbody>
<actuator><motor joint="a"/><position class="leg" joint="b"/><motor joint="d" gear="2"/></actuator></mujoco>"""


def load(folder, angle="", rest="0.3"):
    path = folder / "sprung.xml"
    path.write_text(TREE.format(angle=angle, rest=rest), encoding="utf-8")
    return path, rt.load(path)


def test_springs_come_from_the_nearest_class(tmp_path):
    _, robot = load(tmp_path, ' angle="radian"')
    assert robot.springs == (("a", 3.0, 0.0), ("b", 12.0, 0.3), ("c", 12.0, 0.3))
    assert "Springs pull at a 3 N m/rad" in str(robot)


def test_motors_have_the_ranges_and_gears_of_their_classes(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    path, robot = load(tmp_path)
    assert robot.actuated == ("a", "b", "d")
    low, high = robot.limits.sides("effort")
    np.testing.assert_array_equal([low, high], [[-8, -28, -np.inf, -4], [8, 24, np.inf, 4]])
    model = mujoco.MjModel.from_xml_path(str(path))
    ranges = np.where(model.actuator_forcelimited[:, None], model.actuator_forcerange, model.actuator_ctrlrange)
    np.testing.assert_array_equal(np.array([low, high])[:, [0, 1, 3]].T, model.actuator_gear[:, :1] * ranges)


@pytest.mark.parametrize(("angle", "rest"), [("", "20"), (' angle="radian"', "0.3")])
def test_accelerations_with_springs_are_those_of_mujoco(tmp_path, angle, rest):
    mujoco = pytest.importorskip("mujoco")
    path, robot = load(tmp_path, angle, rest)
    model = mujoco.MjModel.from_xml_path(str(path))
    flags = mujoco.mjtDisableBit
    model.opt.disableflags |= flags.mjDSBL_CONSTRAINT | flags.mjDSBL_ACTUATION
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(5):
        q, v, tau = rng.uniform(-1.0, 1.0, (3, 4))
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, v, tau
        mujoco.mj_forward(model, data)
        own = pin.aba(robot.model, robot.model.createData(), q, v, tau - robot.resistance(q, v))
        np.testing.assert_allclose(own, data.qacc, rtol=1e-8, atol=1e-8)


def test_springs_of_the_caller_replace_those_of_the_file_and_locked_joints_have_none(tmp_path):
    path, _ = load(tmp_path, ' angle="radian"')
    assert rt.load(path, springs={"d": 2.0}).springs == (("d", 2.0, 0.0),)
    assert rt.load(path, locked={"b": 0.1}).springs == (("a", 3.0, 0.0), ("c", 12.0, 0.3))


@pytest.mark.parametrize("given", ['ref="0.2"', 'springdamper="0.1 1"', 'stiffness="1 2"'])
def test_springs_that_are_not_read_are_named(tmp_path, given):
    path = tmp_path / "sprung.xml"
    text = TREE.format(angle=' angle="radian"', rest="0.3")
    path.write_text(text.replace('name="b" axis', f'name="b" {given} axis'), encoding="utf-8")
    with pytest.warns(UserWarning, match="Springs of the MJCF that are not read: 'b'. Set them with springs="):
        robot = rt.load(path)
    assert [joint for joint, _, _ in robot.springs] == ["a", "c"]
