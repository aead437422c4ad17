import builtins
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.dynamics.point import symbolic_model
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.witness.mujoco import mujoco_robot
from tests.robot.coupling.random_trees import random_tree

mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")


def accelerations(robot, seed):
    """MuJoCo's and Pinocchio's acceleration at a random state, under random torques."""
    random = np.random.default_rng(seed)
    model = robot.model
    q = pin.integrate(model, pin.neutral(model), random.uniform(-1, 1, model.nv))
    v, tau = random.uniform(-3, 3, model.nv), random.uniform(-5, 5, model.nv)
    second = mujoco_robot(robot)
    data = mujoco.MjData(second.model)
    data.qpos[:] = second.coordinates.qpos(q)
    data.qvel[:] = second.coordinates.qvel(q, v)
    data.qfrc_applied[:] = second.coordinates.force(q, tau)
    mujoco.mj_forward(second.model, data)
    np.testing.assert_allclose(second.coordinates.q(data.qpos), q, atol=1e-14)
    np.testing.assert_allclose(second.coordinates.v(q, data.qvel), v, atol=1e-14)
    expected = pin.aba(model, model.createData(), q, v, tau - robot.damping * v)
    return second.coordinates.acceleration(q, v, data.qacc), expected


def agree(found, expected):
    np.testing.assert_allclose(found, expected, atol=1e-10 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("name", ["acrobot", "cartpole", "ur5", "panda", "solo12", "talos"])
@pytest.mark.parametrize("seed", range(3))
def test_accelerations_are_pinocchios(name, seed):
    robot = rt.load(name)
    agree(*accelerations(replace(robot, friction=np.zeros(robot.nv)), seed))


def legged(make, root):
    """Trunk with two legs; the joints come breadth first, where MuJoCo goes depth first."""
    model = pin.Model()
    parent = 0
    for name, joint in root:
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), name)
    # About the pitch axis alone, as planar models are written: no solid body has this inertia.
    planar = pin.Inertia(3.0, np.array([0.1, 0.0, 0.2]), np.diag([0.0, 0.3, 0.0]))
    full = pin.Inertia(3.0, np.array([0.1, 0.0, 0.2]), np.diag([0.2, 0.3, 0.25]))
    model.appendBodyToJoint(parent, planar if len(root) == 3 else full, pin.SE3.Identity())
    point = pin.Inertia(0.5, np.array([0.0, 0.1, -0.3]), np.zeros((3, 3)))
    pin.seed(4)
    ends = {}
    for name in ("right_hip", "left_hip", "right_knee", "left_knee"):
        above = ends.get(name.replace("knee", "hip"), parent)
        tilted = pin.JointModelRevoluteUnaligned(np.array([0.0, 0.6, 0.8]))
        ends[name] = model.addJoint(above, tilted, pin.SE3.Random(), name)
        model.appendBodyToJoint(ends[name], point, pin.SE3.Random())
    model.armature = np.concatenate([np.zeros(model.nv - 4), [0.1, 0.2, 0.3, 0.4]])

    class Legged:
        nv, damping, friction, springs = model.nv, np.linspace(0.1, 0.4, model.nv), np.zeros(model.nv), ()

    Legged.model = model
    if len(root) == 1:
        Legged.damping = np.concatenate([np.zeros(6), np.ones(4)])
    return Legged


PLANAR = [("root_x", pin.JointModelPX()), ("root_z", pin.JointModelPZ()), ("root_pitch", pin.JointModelRY())]


@pytest.mark.parametrize("root", [PLANAR, [("root_joint", pin.JointModelFreeFlyer())]], ids=["planar", "floating"])
@pytest.mark.parametrize("seed", range(3))
def test_accelerations_of_a_moving_base_are_pinocchios(make, root, seed):
    agree(*accelerations(legged(make, root), seed))


def test_dry_friction_holds_a_joint_that_the_smoothed_one_lets_creep(make):
    robot = make.robot([("hinge", pin.JointModelRY())], friction=1.0)
    second = mujoco_robot(robot)
    data = mujoco.MjData(second.model)
    data.qfrc_applied[:] = 0.5
    mujoco.mj_forward(second.model, data)
    assert abs(data.qacc[0]) < 0.05
    data.qfrc_applied[:] = 1.5
    mujoco.mj_forward(second.model, data)
    # 0.5 N m are left for a point mass of 1 kg at 1 m.
    assert data.qacc[0] == pytest.approx(0.5, rel=1e-3)


def test_joint_limits_push_back(make):
    robot = make.robot([("hinge", pin.JointModelRY())])
    robot.model.gravity.setZero()
    limits = rt.robot.Limits.none(["hinge"]).with_(position=1.0, velocity=9.0, effort=9.0)
    pushed = []
    for given in (None, limits):
        second = mujoco_robot(robot, given)
        data = mujoco.MjData(second.model)
        data.qpos[:] = 1.01
        mujoco.mj_forward(second.model, data)
        pushed.append(float(data.qacc[0]))
    assert pushed[0] == pytest.approx(0, abs=1e-12) and pushed[1] < -1


def test_other_joints_are_refused_by_name(make):
    robot = make.robot([("ball", pin.JointModelSpherical())])
    with pytest.raises(InputError, match="Joint 'ball' is a Spherical"):
        mujoco_robot(robot)


def test_without_mujoco_the_extra_is_named(make, monkeypatch):
    known = builtins.__import__

    def refuse(name, *rest, **more):
        if name == "mujoco":
            raise ImportError(name)
        return known(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(InputError, match=r"pip install 'robotraj\[mujoco\]'"):
        mujoco_robot(make.robot([("hinge", pin.JointModelRY())]))


@pytest.mark.parametrize("seed", range(20))
def test_accelerations_of_joints_that_follow_others_are_the_planners(seed):
    """MuJoCo's own mass matrix and bias of all joints, projected on the leaders, share no code with the planner."""
    robot = rt.load(coupled(*random_tree(seed, floating=seed % 2 == 1)), root="floating" if seed % 2 else "fixed")
    random, model = np.random.default_rng(seed), robot.model
    q = pin.integrate(model, pin.neutral(model), random.uniform(-1, 1, model.nv))
    v, tau = random.uniform(-1, 1, model.nv), random.uniform(-5, 5, model.nv)
    second = mujoco_robot(replace(robot, damping=np.zeros(robot.nv)))
    second.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, where = mujoco.MjData(second.model), second.coordinates
    data.qpos[:], data.qvel[:] = where.qpos(q), where.qvel(q, v)
    mujoco.mj_forward(second.model, data)
    shares = np.column_stack([where.qvel(q, unit) for unit in np.eye(model.nv)])
    full = np.zeros((second.model.nv, second.model.nv))
    for column, unit in zip(full, np.eye(second.model.nv), strict=True):
        mujoco.mj_mulM(second.model, data, column, unit)
    applied = where.force(q, tau) - data.qfrc_bias
    # Rates of S are those of the root's axes, which ``acceleration`` converts.
    here = np.linalg.solve(shares.T @ full @ shares, shares.T @ applied)
    found = where.acceleration(q, v, shares @ here)
    no_force = np.zeros((6, model.njoints))
    planned = np.array(symbolic_model(robot).forward_dynamics(q, v, tau, no_force)).ravel()
    np.testing.assert_allclose(found, planned, atol=1e-9 * (1 + np.abs(planned).max()))
