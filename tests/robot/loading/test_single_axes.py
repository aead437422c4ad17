"""Joints of several degrees of freedom move, weigh and carry frames as the chains that replace them."""

from __future__ import annotations

import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.loading.single_axes import single_axes

KINDS = {
    "planar": pin.JointModelPlanar(),
    "translation": pin.JointModelTranslation(),
    "angles": pin.JointModelSphericalZYX(),
    "ball": pin.JointModelSpherical(),
    "universal": pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.8, 0.6])),
}


def composite():
    joint = pin.JointModelComposite()
    joint.addJoint(pin.JointModelPX())
    joint.addJoint(pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])))
    return joint


def tree(kind, seed=0):
    """Three joints, the second one of the kind, with random placements, inertias and a branch."""
    rng, model = np.random.default_rng(seed), pin.Model()
    parent = 0
    for name, joint in (
        ("first", pin.JointModelRY()),
        ("wide", kind),
        ("last", pin.JointModelRX()),
        ("side", pin.JointModelPZ()),
    ):
        parent = model.addJoint(parent if name != "side" else 2, joint, pin.SE3.Random(), name)
        model.addJointFrame(parent)
        model.appendBodyToJoint(parent, pin.Inertia.Random(), pin.SE3.Random())
        model.addBodyFrame(f"{name}_link", parent, pin.SE3.Random(), -1)
    model.armature[:] = rng.uniform(0.1, 1.0, model.nv)
    model.lowerEffortLimit, model.upperEffortLimit = -np.arange(1.0, model.nv + 1), np.arange(1.0, model.nv + 1)
    model.lowerVelocityLimit, model.upperVelocityLimit = -np.arange(2.0, model.nv + 2), np.arange(3.0, model.nv + 3)
    return model


@pytest.mark.parametrize("kind", [*KINDS, "composite"])
@pytest.mark.parametrize("seed", range(4))
def test_kinetic_energy_gravity_and_frames_are_those_of_the_chain(kind, seed):
    """Both have the same masses, and equal frame placements and mass matrices where their rates are the same."""
    model = tree(KINDS.get(kind) or composite(), seed)
    chain, names = single_axes(model)
    assert list(names) == ["wide"] and all(part.startswith("wide_") for part in names["wide"])
    assert chain.nv == model.nv == chain.nq
    q = np.random.default_rng(seed).uniform(-1.0, 1.0, chain.nq)
    wide = q[1 : 1 + model.joints[2].nv]
    if kind == "planar":
        at = np.array([*wide[:2], np.cos(wide[2]), np.sin(wide[2])])
    elif kind == "ball":
        turned = pin.rpy.rpyToMatrix(*wide[::-1])
        at = pin.Quaternion(turned).coeffs()
    else:
        at = wide
    whole = np.concatenate([q[:1], at, q[1 + len(wide) :]])
    data, other = model.createData(), chain.createData()
    pin.framesForwardKinematics(model, data, whole)
    pin.framesForwardKinematics(chain, other, q)
    for frame in model.frames:
        if frame.name == "wide":
            continue  # it becomes the frames of the new joints
        one, two = data.oMf[model.getFrameId(frame.name)], other.oMf[chain.getFrameId(frame.name)]
        np.testing.assert_allclose(two.homogeneous, one.homogeneous, atol=1e-12)
    assert pin.computePotentialEnergy(chain, other, q) == pytest.approx(pin.computePotentialEnergy(model, data, whole))
    if kind not in ("planar", "ball", "angles"):  # rates in the axes of the body, and those of the chain
        v, a = np.random.default_rng(seed).standard_normal((2, model.nv))
        np.testing.assert_allclose(
            pin.rnea(chain, other, q, v, a), pin.rnea(model, data, whole, v, a), rtol=1e-10, atol=1e-10
        )
    for field in ("armature", "lowerEffortLimit", "upperEffortLimit", "lowerVelocityLimit", "upperVelocityLimit"):
        np.testing.assert_array_equal(getattr(chain, field), getattr(model, field))


PLANAR = (
    '<robot name="m"><link name="world"/><link name="base">{0}</link><link name="arm">{0}</link>'
    '<joint name="{1}" type="{2}"><parent link="world"/><child link="base"/>{3}</joint>'
    '<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
    '<limit lower="-2" upper="2" velocity="20" effort="60"/></joint></robot>'
)
BODY = (
    '<inertial><origin xyz="0 0 -0.1"/><mass value="1"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def test_a_base_on_a_planar_joint_plans_and_agrees_with_the_second_opinion(urdf):
    robot = rt.load(urdf.text(PLANAR.format(BODY, "drive", "planar", '<axis xyz="0 0 1"/>')))
    assert robot.joint_names == ("drive_x", "drive_y", "drive_yaw", "j")
    assert any("'drive' moves by drive_x, drive_y, drive_yaw" in note for note in robot.notes)
    assert np.isinf(robot.limits.position_upper[:3]).all()
    end = rt.State(q={"drive_x": 1.0, "drive_y": 0.5, "drive_yaw": 1.0, "j": 0.4}, v=0)
    solution = rt.plan(rt.Phase(robot, 2.0, rt.State(q=0, v=0), end, rt.Effort()), progress=False)
    assert solution.proof.holds
    assert rt.validate(solution).passed
    pytest.importorskip("mujoco")
    assert rt.witness.second_opinion(solution).completed
    assert rt.load_solution(solution.save(urdf.folder / "s.npz")).problem.phases[0].robot.model == robot.model
    locked = rt.load(urdf.text(PLANAR.format(BODY, "drive", "planar", "")), locked={"drive_x": 0.0, "drive_y": 0.0})
    assert locked.joint_names == ("drive_yaw", "j")


def test_the_name_in_the_file_stands_for_the_joints_in_its_place(urdf):
    """A planar base is held still, or has motors, by its own name; a ball likewise, from a URDF or a model."""
    text = PLANAR.format(BODY, "drive", "planar", '<axis xyz="0 0 1"/>')
    held = rt.load(urdf.text(text), locked={"drive": 0.0})
    assert held.joint_names == ("j",)
    place = (1.0, -0.5, 0.3)
    held = rt.load(urdf.text(text), locked={"drive": place})
    data = held.model.createData()
    pin.framesForwardKinematics(held.model, data, np.zeros(1))
    base = data.oMf[held.frame("base")]
    np.testing.assert_allclose([*base.translation[:2], pin.log3(base.rotation)[2]], place, atol=1e-12)
    assert rt.load(urdf.text(text), actuated=["drive"]).actuated == ("drive_x", "drive_y", "drive_yaw")
    for given in (0.4, (1.0, 2.0), "here"):
        with pytest.raises(rt.InputError, match=r"'drive' moves by drive_x, drive_y, drive_yaw; got .* Give 3 numbers"):
            rt.load(urdf.text(text), locked={"drive": given})
    with pytest.raises(rt.InputError, match="'drive_y' at nan; give one finite number"):
        rt.load(urdf.text(text), locked={"drive": (0.0, np.nan, 0.0)})
    ball = rt.load(urdf.text(PLANAR.format(BODY, "neck", "spherical", "")), locked={"neck": (0.1, 0.2, 0.3)})
    other = rt.load(tree(pin.JointModelSpherical()), locked={"wide": 0.0})
    assert ball.joint_names == ("j",) and other.joint_names == ("first", "last", "side")


def test_the_pitch_of_a_ball_stays_where_its_speeds_are_defined(urdf):
    """A ball has no position limits of its own; narrower ones of the angles are kept, and the note states the bound."""
    balls = (
        rt.load(urdf.text(PLANAR.format(BODY, "neck", "spherical", ""))),
        rt.load(tree(pin.JointModelSpherical())),
    )
    for robot, pitch in zip(balls, ("neck_pitch", "wide_pitch"), strict=True):
        k = robot.velocity_names.index(pitch)
        assert [side[k] for side in robot.limits.sides("position")] == [-1.4, 1.4]
        assert all(np.isinf(side[[k - 1, k + 1]]).all() for side in robot.limits.sides("position"))
        assert any("stays within 1.4 rad" in note for note in robot.notes)
    model = tree(pin.JointModelSphericalZYX())
    model.lowerPositionLimit, model.upperPositionLimit = np.full(model.nq, -0.5), np.full(model.nq, 2.0)
    robot = rt.load(model)
    assert [side[2] for side in robot.limits.sides("position")] == [-0.5, 1.4]
    assert [side[1] for side in robot.limits.sides("position")] == [-0.5, 2.0]


def test_a_plane_that_pinocchio_does_not_read_is_refused(urdf):
    with pytest.raises(rt.InputError, match="planar joint 'drive' has the axis '0 1 0'"):
        rt.load(urdf.text(PLANAR.format(BODY, "drive", "planar", '<axis xyz="0 1 0"/>')))


def test_a_fixed_joint_with_a_name_of_the_root_is_no_obstacle(urdf):
    text = PLANAR.format(BODY, "root_joint", "fixed", "")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = rt.load(urdf.text(text), root="floating")
    assert robot.nq == 8
    assert "root_joint_fixed" in robot.frame_names


@pytest.mark.parametrize("kind", [pin.JointModelHX, pin.JointModelHY, pin.JointModelHZ])
def test_a_screw_takes_the_energy_that_its_plan_states(kind):
    """Work of the motor equals the gain of potential energy, which Pinocchio computes for the model as given."""
    model = pin.Model()
    turn = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.9, 0.4), np.zeros(3))
    joint = model.addJoint(0, kind(0.05), turn, "screw")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, np.array([0.1, 0.2, -0.3]), 0.02 * np.eye(3)), pin.SE3.Identity())
    robot = rt.load(model)
    assert not any("chains" in note for note in robot.notes)
    ends = rt.State(q=0.0, v=0.0), rt.State(q=1.5, v=0.0)
    solution = rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort(), limits=None), rt.Mesh(20))
    t = np.linspace(0.0, 1.0, 2001)
    samples = solution.at(t)
    work = np.trapezoid(samples.tau[:, 0] * samples.v[:, 0], t)
    gained = np.diff([pin.computePotentialEnergy(model, model.createData(), np.array([q])) for q in (0.0, 1.5)])[0]
    assert abs(gained) > 0.1
    assert work == pytest.approx(gained, rel=1e-3)
