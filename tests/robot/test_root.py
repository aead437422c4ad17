"""Planar and floating roots are Pinocchio's own composite and free-flyer models, by name and without motors."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.point import symbolic_model
from robotraj.robot.known_robots.catalogue import catalogue, find
from robotraj.robot.known_robots.example_robots import folder

SAME = ("solo12", "talos", "bolt", "tiago_no_hand", "kinova")
"""Robots with rotors, with many fixed frames, with continuous joints."""
HEIGHTS = {"solo12": 0.235, "talos": 1.01927, "bolt": 0.35487417, "go2": 0.335, "laikago": 0.0}


def composite(root):
    if root == "floating":
        return pin.JointModelFreeFlyer()
    planar = pin.JointModelComposite()
    for joint in (pin.JointModelPX(), pin.JointModelPZ(), pin.JointModelRY()):
        planar.addJoint(joint, pin.SE3.Identity())
    return planar


def random_state(model, planning, rng):
    """A configuration of Pinocchio's own model and the same of the planning model, v, a and tau."""
    v, a, tau = rng.normal(size=(3, planning.nv))
    mine = pin.integrate(planning, pin.neutral(planning), rng.uniform(-2, 2, planning.nv))
    n = planning.nq - planning.nv  # 1 with a free-flyer
    q = pin.neutral(model)
    first = 7 if n else 3
    q[:first] = mine[:first]
    for name, value in zip(list(planning.names)[2 if n else 4 :], mine[first:], strict=True):
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
    return q, mine, v, a, tau


@pytest.mark.parametrize("root", ["planar", "floating"])
@pytest.mark.parametrize("name", SAME)
def test_kinematics_and_dynamics_are_those_of_pinocchios_own_root(name, root):
    model = pin.buildModelFromUrdf(str(find(name).urdf), composite(root))
    robot = rt.load(name, root=root)
    planning = robot.model
    model.armature[:] = planning.armature
    one, other = model.createData(), planning.createData()
    rng = np.random.default_rng(1)
    frames = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    for _ in range(5):
        q, mine, v, a, tau = random_state(model, planning, rng)
        np.testing.assert_allclose(pin.rnea(planning, other, mine, v, a), pin.rnea(model, one, q, v, a), atol=1e-8)
        np.testing.assert_allclose(pin.aba(planning, other, mine, v, tau), pin.aba(model, one, q, v, tau), rtol=1e-7)
        for m, d, at in ((model, one, q), (planning, other, mine)):
            pin.forwardKinematics(m, d, at, v)
            pin.updateFramePlacements(m, d)
        for frame in frames:
            i, k = robot.frame(frame), model.getFrameId(frame, pin.FrameType.BODY)
            np.testing.assert_allclose(other.oMf[i].homogeneous, one.oMf[k].homogeneous, atol=1e-12)
            speed = pin.getFrameVelocity(model, one, k).vector
            np.testing.assert_allclose(pin.getFrameVelocity(planning, other, i).vector, speed, atol=1e-11)


def test_the_symbolic_algorithms_know_the_root():
    rng = np.random.default_rng(2)
    for root in ("planar", "floating"):
        robot = rt.load("solo12", root=root)
        model, data = robot.model, robot.model.createData()
        q = pin.integrate(model, robot.neutral, rng.normal(size=model.nv))
        v, a = rng.normal(size=(2, model.nv))
        tau = np.array(symbolic_model(robot).inverse_dynamics(q, v, a, np.zeros((6, model.njoints)))).ravel()
        np.testing.assert_allclose(tau, pin.rnea(model, data, q, v, a), atol=1e-11)


@pytest.mark.parametrize("entry", catalogue(), ids=lambda entry: entry.name)
def test_every_robot_loads_with_a_moving_root(entry):
    fixed = rt.load(entry.name)
    planar, floating = (rt.load(entry.name, root=root) for root in ("planar", "floating"))
    idle = set(fixed.joint_names) - set(floating.joint_names)
    if idle:  # joints that move no mass
        assert entry.name == "icub" and idle == {"neck_yaw"}
        fixed = rt.load(entry.name, locked={"neck_yaw": 0.0})
    assert (planar.nq, planar.nv) == (fixed.nv + 3, fixed.nv + 3)
    assert (floating.nq, floating.nv) == (fixed.nv + 7, fixed.nv + 6)
    for robot in (planar, floating):
        assert robot.actuated == fixed.actuated
        first = robot.nv - fixed.nv
        assert robot.velocity_names[first:] == robot.position_names[robot.nq - fixed.nv :] == fixed.joint_names
        np.testing.assert_array_equal(robot.neutral[robot.nq - fixed.nv :], fixed.neutral)
        np.testing.assert_array_equal(robot.damping, np.append(np.zeros(first), fixed.damping))
        assert set(fixed.frame_names) <= set(robot.frame_names)
        assert not robot.actuation[:first].any()
        for values in (robot.limits.velocity, robot.limits.effort, robot.limits.position_upper):
            assert np.isposinf(values[:first]).all()
    assert np.linalg.norm(floating.neutral[3:7]) == pytest.approx(1.0, abs=1e-15)


def test_names_and_units():
    planar, floating = (rt.load("cartpole", root=root) for root in ("planar", "floating"))
    assert planar.position_names == planar.velocity_names == planar.joint_names
    assert planar.joint_names == ("root_x", "root_z", "root_pitch", "slider", "pole")
    assert planar.units == planar.position_units == ("m", "m", "rad", "m", "rad")
    assert floating.joint_names == ("root_joint", "slider", "pole")
    assert floating.position_names == (
        *("root_x", "root_y", "root_z", "root_qx", "root_qy", "root_qz", "root_qw"),
        *("slider", "pole"),
    )
    assert floating.velocity_names == (
        *("root_vx", "root_vy", "root_vz", "root_wx", "root_wy", "root_wz"),
        *("slider", "pole"),
    )
    assert floating.position_units == ("m", "m", "m", "", "", "", "", "m", "rad")
    assert floating.units == ("m", "m", "m", "rad", "rad", "rad", "m", "rad")
    assert floating.limits.joints == floating.velocity_names
    assert (rt.load("cartpole").root, planar.root, floating.root) == ("fixed", "planar", "floating")
    assert rt.load("cartpole").position_names == ("slider", "pole")
    assert [robot.joint("pole") for robot in (planar, floating)] == [4, 7]
    np.testing.assert_array_equal(floating.actuation[:, 0], [0, 0, 0, 0, 0, 0, 1, 0])


@pytest.mark.parametrize("name", HEIGHTS)
def test_the_reference_of_the_srdf_places_the_root(name):
    planar, floating = (rt.load(name, root=root).neutral for root in ("planar", "floating"))
    np.testing.assert_allclose(floating[:7], [0, 0, HEIGHTS[name], 0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(planar[:3], [0, HEIGHTS[name], 0], atol=1e-12)
    np.testing.assert_array_equal(planar[3:], floating[7:])


def test_a_models_own_reference_places_both_roots():
    model = pin.buildModelFromUrdf(str(find("cartpole").urdf), pin.JointModelFreeFlyer())
    turn = pin.Quaternion(pin.utils.rotate("y", 0.3)).coeffs()
    model.referenceConfigurations["home"] = np.concatenate([[1, 2, 3], turn, [0.1, 0.2]])
    np.testing.assert_allclose(rt.load(model, root="floating").neutral, [1, 2, 3, *turn, 0.1, 0.2], atol=1e-15)
    model.referenceConfigurations["home"] = np.concatenate([[1, 2, 3], 2 * turn, [0.1, 0.2]])
    with pytest.raises(rt.InputError, match=r"'home'.*length 2"):
        rt.load(model, root="floating")


def test_the_pitch_nearest_to_a_quaternion():
    from robotraj.robot.root import in_plane

    for angle in (-2.5, 0.4, 3.0):
        q = np.array([1, 2, 3, 0, np.sin(angle / 2), 0, np.cos(angle / 2)])
        np.testing.assert_allclose(in_plane(q), [1, 3, angle], atol=1e-12)


@pytest.mark.parametrize("name", ["solo12", "kinova"])
def test_a_model_that_flies_already_loads_as_floating(name):
    model = pin.buildModelFromUrdf(str(find(name).urdf), pin.JointModelFreeFlyer(), "trunk")
    before = model.saveToString()
    robot, expected = rt.load(model, root="floating"), rt.load(name, root="floating")
    assert model.saveToString() == before
    assert robot.joint_names == expected.joint_names
    assert "root_joint" in robot.frame_names and "trunk" not in robot.frame_names
    robot.model.armature[:] = expected.model.armature
    q = pin.integrate(robot.model, expected.neutral, np.full(robot.nv, 0.3))
    v, tau = np.random.default_rng(0).normal(size=(2, robot.nv))
    accelerations = [pin.aba(r.model, r.model.createData(), q, v, tau) for r in (robot, expected)]
    np.testing.assert_allclose(*accelerations, rtol=1e-9)


@pytest.mark.parametrize("root", ["planar", "floating"])
def test_what_a_joint_has_stays_with_it(root):
    model = pin.buildModelFromUrdf(str(find("cartpole").urdf))
    for name in ("armature", "damping", "upperDryFrictionLimit"):
        getattr(model, name)[:] = np.random.default_rng(3).uniform(1, 2, 2)
    model.gravity.linear = np.array([0, 0, -1.62])
    robot = rt.load(model, root=root)
    first = robot.nv - 2
    for name in ("armature", "damping", "upperDryFrictionLimit"):
        np.testing.assert_array_equal(getattr(robot.model, name), np.append(np.zeros(first), getattr(model, name)))
    np.testing.assert_array_equal(robot.model.gravity.linear, [0, 0, -1.62])
    np.testing.assert_array_equal(robot.limits.position_upper[first:], rt.robot.Limits.of(model).position_upper)


@pytest.mark.parametrize("root", ["planar", "floating"])
@pytest.mark.parametrize("locked", [{}, {"FL_KFE": -1.0}])
def test_shapes_are_carried_along(root, locked):
    share = str(folder().parents[1])
    path = str(find("solo12").urdf)
    model = pin.buildModelFromUrdf(path, composite(root))
    expected = pin.buildGeomFromUrdf(model, path, pin.GeometryType.VISUAL, None, share)
    wrapper = pin.RobotWrapper.BuildFromURDF(path, [share])
    rng = np.random.default_rng(4)
    for source in ("solo12", wrapper):
        robot = rt.load(source, root=root, locked=locked)
        mine = pin.integrate(robot.model, pin.neutral(robot.model), rng.normal(size=robot.nv))
        first = robot.nq - 12 + len(locked)
        joints = dict(zip(robot.position_names[first:], mine[first:], strict=True)) | locked
        q = np.append(mine[:first], [joints[name] for name in list(model.names)[2:]])
        places = [shapes.createData() for shapes in (expected, robot.visual_model)]
        pin.updateGeometryPlacements(model, model.createData(), expected, places[0], q)
        pin.updateGeometryPlacements(robot.model, robot.model.createData(), robot.visual_model, places[1], mine)
        assert robot.visual_model.ngeoms == expected.ngeoms
        for one, other in zip(places[0].oMg, places[1].oMg, strict=True):
            np.testing.assert_allclose(other.homogeneous, one.homogeneous, atol=1e-12)
    assert wrapper.visual_model.geometryObjects[0].parentJoint == 0


def test_a_body_without_joints_can_be_thrown(urdf):
    path = urdf.text(
        '<robot name="brick"><link name="brick"><inertial><mass value="2"/>'
        '<inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    with pytest.raises(rt.InputError, match="no moving joint"):
        rt.load(path)
    robot = rt.load(path, root="floating")
    assert (robot.nq, robot.nv, robot.nu) == (7, 6, 0)
    assert symbolic_model(robot).mass == 2.0
    held = rt.load("pendulum", root="planar", locked={"pivot": 0.4})
    assert held.joint_names == ("root_x", "root_z", "root_pitch")


@pytest.mark.parametrize("root", ["planar", "floating"])
def test_random_configurations_are_finite_and_the_root_has_no_limits(root):
    for source in ("solo12", pin.buildModelFromUrdf(str(find("solo12").urdf), pin.JointModelFreeFlyer())):
        if root == "planar" and source != "solo12":
            continue
        robot = rt.load(source, root=root)
        for _ in range(5):
            q = pin.randomConfiguration(robot.model)
            assert np.abs(q).max() <= 10
            np.testing.assert_array_equal(robot.configuration(q).shape, (robot.nq,))
        first = robot.nv - 12
        assert np.isposinf(robot.limits.position_upper[:first]).all()


def test_limits_for_all_joints_leave_the_root_free():
    robot = rt.load("cartpole", root="floating", limits={"velocity": 3.0, "position": 1.0, "effort": 7.0})
    for values, last in ((robot.limits.velocity, 3), (robot.limits.position_upper, 1), (robot.limits.effort, 7)):
        np.testing.assert_array_equal(values, [*[np.inf] * 6, last, last])
    lower, upper = robot.limits.positions
    np.testing.assert_array_equal(upper, [*[np.inf] * 7, 1, 1])
    np.testing.assert_array_equal(lower, -upper)
    named = rt.load("cartpole", root="planar", limits={"position": {"root_z": (0, 2)}, "velocity": {"root_x": 1}})
    assert (named.limits.position_upper[1], named.limits.velocity[0]) == (2, 1)
    assert rt.load("cartpole", root="floating", limits={"velocity": {"root_wx": 4}}).limits.velocity[3] == 4


def test_configurations_of_a_floating_root_are_checked():
    robot = rt.load("cartpole", root="floating")
    q = robot.configuration({"root_z": 0.5, "pole": 0.2})
    np.testing.assert_array_equal(q, [0, 0, 0.5, 0, 0, 0, 1, 0, 0.2])
    np.testing.assert_array_equal(robot.velocity({"root_wy": 2.0}), [0, 0, 0, 0, 2, 0, 0, 0])
    nearly = robot.configuration([0, 0, 0, 0.6, 0, 0, 0.8 + 1e-8, 0, 0])
    assert np.linalg.norm(nearly[3:7]) == pytest.approx(1.0, abs=1e-15)
    with pytest.raises(rt.InputError, match=r"'start'|start: the quaternion .*\(0.5, 0, 0, 0.5\).*length 0.707"):
        robot.configuration([0, 0, 0, 0.5, 0, 0, 0.5, 0, 0], "start")
    with pytest.raises(rt.InputError, match=r"shape \(8,\).*9 values.*root_qw"):
        robot.configuration(np.zeros(8))


def test_printing_shows_the_root():
    text = str(rt.load("solo12", root="floating"))
    assert "solo12: floating root, 12 moving joints, 12 actuated, 2.5 kg moving" in text
    assert "root_z 0.235 m" in text and "root_qw 1" in text and "root link's own axes" in text
    planar = str(rt.load("solo12", root="planar"))
    assert "planar root, 12 moving joints" in planar and "root_pitch" in planar


# -- bad inputs --------------------------------------------------------------------------------------------


def taken(urdf, name):
    return urdf.chain((name, "revolute", "0 0 1"), ("b", "prismatic", "0 1 0"))


BAD = {
    "planar name taken": (lambda urdf: rt.load(taken(urdf, "root_z"), root="planar"), ["'root_z'", "Rename"]),
    "floating joint taken": (lambda urdf: rt.load(taken(urdf, "root_joint"), root="floating"), ["'root_joint'"]),
    "floating velocity taken": (lambda urdf: rt.load(taken(urdf, "root_wx"), root="floating"), ["'root_wx'"]),
    "flies and fixed": (
        lambda urdf: rt.load(pin.buildSampleModelHumanoidRandom(), root="fixed"),
        ["'root_joint'", "root='floating'"],
    ),
    "flies and planar": (
        lambda urdf: rt.load(pin.buildSampleModelHumanoidRandom(), root="planar"),
        ["'root_joint'", "root='planar'", "free joint"],
    ),
    "locked root": (lambda urdf: rt.load("cartpole", root="planar", locked={"root_z": 0}), ["'root_z'", "slider"]),
    "locked free-flyer": (
        lambda urdf: rt.load("cartpole", root="floating", locked={"root_joint": 0}),
        ["'root_joint'", "slider, pole"],
    ),
    "motors of the root": (
        lambda urdf: rt.load("cartpole", root="floating", actuated=["root_vx"]),
        ["'root_vx'", "slider, pole"],
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_roots_are_refused_by_name(case, urdf):
    load, parts = BAD[case]
    with pytest.raises(rt.InputError) as caught:
        load(urdf)
    for part in parts:
        assert part in str(caught.value)
