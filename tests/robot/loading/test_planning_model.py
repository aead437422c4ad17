"""The planning model has the dynamics and the frames of the model it was made from."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find
from robotraj.robot.loading.planning_model import angles, reduced, with_angles

CONTINUOUS = ("kinova", "double_pendulum_continuous", "tiago_no_hand")


def with_cosines(model, angle):
    """Return the configuration of the original model for the angles."""
    q = pin.neutral(model)
    for joint in list(model.joints)[1:]:
        value = angle[joint.idx_v]
        q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
    return q


def assert_same_mechanism(original, planning, q_of):
    data, copy = original.createData(), planning.createData()
    rng = np.random.default_rng(1)
    for _ in range(20):
        angle = rng.uniform(-3, 3, planning.nq)
        v, tau = rng.normal(size=(2, planning.nv))
        q = q_of(angle)
        expected = pin.aba(original, data, q, v, tau)
        np.testing.assert_allclose(pin.aba(planning, copy, angle, v, tau), expected, rtol=1e-9, atol=1e-9)
        pin.framesForwardKinematics(original, data, q)
        pin.framesForwardKinematics(planning, copy, angle)
        for one, other in zip(data.oMf, copy.oMf, strict=True):
            np.testing.assert_allclose(other.homogeneous, one.homogeneous, atol=1e-12)


@pytest.mark.parametrize("name", CONTINUOUS)
def test_continuous_joints_become_angles_of_the_same_mechanism(name):
    original = pin.buildModelFromUrdf(str(find(name).urdf))
    assert original.nq > original.nv
    planning = rt.load(name).model
    assert planning.nq == planning.nv == original.nv
    assert list(planning.names) == list(original.names)
    assert [f.name for f in planning.frames] == [f.name for f in original.frames]
    assert [f.parentJoint for f in planning.frames] == [f.parentJoint for f in original.frames]
    assert [f.type for f in planning.frames] == [f.type for f in original.frames]
    assert_same_mechanism(original, planning, lambda angle: with_cosines(original, angle))


def test_a_continuous_joint_about_any_axis(urdf):
    path = urdf.chain(("a", "continuous", "1 2 -1"), ("b", "prismatic", "0 1 1"), ("c", "continuous", "0 -1 0"))
    original = pin.buildModelFromUrdf(str(path))
    robot = rt.load(path)
    assert robot.units == ("rad", "m", "rad")
    assert_same_mechanism(original, robot.model, lambda angle: with_cosines(original, angle))


def test_the_angle_is_unlimited_and_speed_and_effort_stay(urdf):
    robot = rt.load(urdf.chain(("a", "continuous", "0 0 1"), ("b", "revolute", "0 0 1")))
    np.testing.assert_array_equal(robot.limits.position_lower, [-np.inf, -1])
    np.testing.assert_array_equal(robot.limits.position_upper, [np.inf, 2])
    np.testing.assert_array_equal(robot.limits.velocity, [3, 3])
    np.testing.assert_array_equal(robot.limits.effort, [4, 4])


def test_everything_a_joint_has_survives_the_rebuilding(urdf):
    model = pin.buildModelFromUrdf(str(urdf.chain(("a", "continuous", "0 0 1"), ("b", "revolute", "0 0 1"))))
    model.gravity.linear = np.array([0, 1.0, -3.0])
    for name in ("armature", "rotorInertia", "rotorGearRatio", "damping", "upperDryFrictionLimit"):
        getattr(model, name)[:] = np.random.default_rng(2).uniform(1, 2, 2)
    planning = with_angles(model)
    for name in ("armature", "rotorInertia", "rotorGearRatio", "damping", "upperDryFrictionLimit"):
        np.testing.assert_array_equal(getattr(planning, name), getattr(model, name))
    np.testing.assert_array_equal(planning.gravity.linear, [0, 1, -3])
    assert planning.name == model.name


def test_a_pair_of_cosine_and_sine_need_not_be_normalised(urdf):
    model = pin.buildModelFromUrdf(str(urdf.chain(("a", "continuous", "0 0 1"), ("b", "revolute", "0 0 1"))))
    np.testing.assert_allclose(angles(model, np.array([3 * np.cos(2.5), 3 * np.sin(2.5), 0.7])), [2.5, 0.7])


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_locked_joints_are_removed_and_the_others_move_alike(name):
    whole = rt.load(name)
    held = {whole.joint_names[1]: 0.4, whole.joint_names[3]: -1.1}
    robot = rt.load(name, locked=held)
    assert robot.joint_names == tuple(joint for joint in whole.joint_names if joint not in held)
    assert robot.frame_names == whole.frame_names
    rng = np.random.default_rng(4)
    one, other = whole.model.createData(), robot.model.createData()
    for _ in range(10):
        q = rng.uniform(-3, 3, robot.nq)
        full = whole.configuration({**dict(zip(robot.joint_names, q, strict=True)), **held})
        pin.framesForwardKinematics(whole.model, one, full)
        pin.framesForwardKinematics(robot.model, other, q)
        for a, b in zip(one.oMf, other.oMf, strict=True):
            np.testing.assert_allclose(b.homogeneous, a.homogeneous, atol=1e-12)
        kept = [whole.joint(joint) for joint in robot.joint_names]
        mass = pin.crba(whole.model, one, full)[np.ix_(kept, kept)]
        np.testing.assert_allclose(pin.crba(robot.model, other, q), mass, atol=1e-9)


@pytest.mark.parametrize("name", ["kinova", "ur5"])
def test_the_callers_model_is_never_written_to(name):
    model = pin.buildModelFromUrdf(str(find(name).urdf))
    model.rotorInertia[:] = 0.01
    model.rotorGearRatio[:] = 10.0
    before = model.saveToString()
    robot = rt.load(model, locked={model.names[2]: 1.0}, limits={"velocity": 0.1})
    robot.model.armature[:] = 5.0
    assert model.saveToString() == before


def test_links_named_like_their_joints_are_distinguished(urdf):
    joints = (("a", "revolute", "0 0 1"), ("b", "continuous", "0 1 0"), ("c", "revolute", "1 0 0"))
    text = urdf.chain(*joints).read_text(encoding="utf-8")
    for link, joint in (("link1", "a"), ("link2", "b"), ("link3", "c")):
        text = text.replace(f'"{link}"', f'"{joint}"')
    twins = rt.load(urdf.text(text))
    plain = rt.load(urdf.chain(*joints))
    assert sorted(twins.frame_names) == ["a", "a_joint", "b", "b_joint", "base", "c", "c_joint", "universe"]
    assert any("a, b, c" in note for note in twins.notes)
    held = rt.load(urdf.text(text), locked={"b": 0.4})
    assert held.joint_names == ("a", "c")
    q = np.array([0.3, 0.4, 0.5])
    for robot, at in ((twins, q), (held, q[[0, 2]])):
        data, expected = robot.model.createData(), plain.model.createData()
        pin.framesForwardKinematics(robot.model, data, at)
        pin.framesForwardKinematics(plain.model, expected, q)
        for name, link in (("c", "link3"), ("b_joint", "b")):
            mine = data.oMf[robot.model.getFrameId(name)].homogeneous
            place = expected.oMf[plain.model.getFrameId(link)].homogeneous
            np.testing.assert_allclose(mine, place, atol=1e-12)


def test_a_joint_without_a_frame_can_be_locked() -> None:
    """A model built by hand may have none; Pinocchio 4.1 ends the process there."""
    model = pin.Model()
    parent = 0
    for name in ("hip", "knee"):
        parent = model.addJoint(parent, pin.JointModelRY(), pin.SE3.Identity(), name)
        model.appendBodyToJoint(parent, pin.Inertia.Random(), pin.SE3.Identity())
    smaller = reduced(model, [2], np.array([0.0, 0.3]))
    assert list(smaller.names) == ["universe", "hip"] and smaller.existFrame("knee")
