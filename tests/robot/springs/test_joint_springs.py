"""Springs pull with -k (q - rest) in plan, proof, simulation and MuJoCo, and count at the leader of a follower."""

from __future__ import annotations

import pickle

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.point import symbolic_model
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.coupling.mimics import Mimic
from tests.robot.coupling.random_trees import random_tree


def slider(**options):
    """Return a mass of 2 kg that slides level."""
    model = pin.Model()
    model.name = "slider"
    free = (np.full(1, x) for x in (50.0, 10.0, -5.0, 5.0))
    joint = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "x", *free)
    model.appendBodyToJoint(joint, pin.Inertia(2.0, np.zeros(3), 0.1 * np.eye(3)), pin.SE3.Identity())
    return rt.load(model, **options)


def test_a_mass_on_a_spring_swings_by_itself_for_half_a_period():
    """m x'' + k (x - rest) = 0 takes x from rest + 1 to rest - 1 in pi sqrt(m / k), without effort."""
    robot = slider(springs={"x": (8.0, 0.5)})
    swing = rt.Phase(robot, np.pi * np.sqrt(2.0 / 8.0), rt.State(q=1.5, v=0), rt.State(q=-0.5, v=0), rt.Effort())
    solution = rt.plan(swing)
    assert solution.objective < 1e-8
    t = np.linspace(0.0, solution.duration, 9)
    np.testing.assert_allclose(solution.at(t).q[:, 0], 0.5 + np.cos(2.0 * t), atol=1e-5)
    assert rt.validate(solution).energy.relative < 1e-6


def test_a_least_time_is_that_of_the_spring_and_the_force():
    """With w = sqrt(k / m) and f = F / k the first half is a circle about f in (x, v / w), of radius f + start.

    By symmetry the force switches at x = 0, where cos(w t) = f / (f + start).
    """
    k, force, start = 8.0, 50.0, 1.0
    robot = slider(springs={"x": k})
    plan = rt.plan(rt.Phase(robot, (0.05, 5.0), rt.State(q=-start, v=0), rt.State(q=start, v=0), rt.Duration()))
    f, w = force / k, np.sqrt(k / 2.0)
    exact = 2.0 * np.arccos(f / (f + start)) / w
    assert plan.duration == pytest.approx(exact, rel=2e-4)
    assert rt.validate(plan).passed


def test_a_balancer_carries_the_arm_that_it_balances():
    """A spring of stiffness m g l at rest upright has the torque of the weight to first order, so holding is free."""
    arm = rt.load("pendulum")
    model, data = arm.model, arm.model.createData()
    slope = pin.computeGeneralizedGravity(model, data, np.array([np.pi + 1e-5]))[0] / 1e-5
    held = rt.load("pendulum", springs={"pivot": (-slope, np.pi)})
    torque = np.array(pin.computeGeneralizedGravity(model, data, np.array([np.pi + 0.01]))) + held.resistance(
        np.array([np.pi + 0.01]), np.zeros(1)
    )
    assert abs(torque[0]) < 1e-3 * abs(0.01 * slope)


@pytest.mark.parametrize("seed", range(10))
def test_accelerations_are_those_of_pinocchio_and_mujoco(seed):
    mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    from robotraj.witness.mujoco import mujoco_robot

    model, _ = random_tree(seed)
    model.damping = np.zeros(model.nv)
    random = np.random.default_rng(seed)
    given = {name: (random.uniform(1, 50), random.normal()) for name in list(model.names)[1::2]}
    robot = rt.load(model, springs=given)
    q, v, tau = random.normal(size=(3, robot.nv))
    stiffness, rest = np.array([given.get(name, (0.0, 0.0)) for name in robot.velocity_names]).T
    pulled = -stiffness * (q - rest)
    expected = pin.aba(robot.model, robot.model.createData(), q, v, tau + pulled)
    np.testing.assert_allclose(-robot.resistance(q, v), pulled, atol=1e-12)
    second = mujoco_robot(robot)
    data, where = mujoco.MjData(second.model), second.coordinates
    data.qpos[:], data.qvel[:] = where.qpos(q), where.qvel(q, v)
    data.qfrc_applied[:] = where.force(q, tau)
    mujoco.mj_forward(second.model, data)
    size = 1e-9 * (1 + np.abs(expected).max())
    np.testing.assert_allclose(where.acceleration(q, v, data.qacc), expected, atol=size)
    point_tau = np.array(symbolic_model(robot).inverse_dynamics(q, v, expected, np.zeros((6, model.njoints)))).ravel()
    np.testing.assert_allclose(point_tau - pulled, tau, atol=1e-8)


def test_a_followers_spring_counts_at_its_leader():
    model, _ = random_tree(0)
    robot = rt.load(coupled(model, [Mimic("j2", "j1", -2.0, 0.3)]), springs={"j2": (5.0, 0.7), "j1": (10.0, 0.1)})
    ((joint, stiffness, rest),) = robot.springs
    assert joint == "j1" and stiffness == pytest.approx(30.0)
    q = 0.4
    torque = -10.0 * (q - 0.1) + -2.0 * -5.0 * (-2.0 * q + 0.3 - 0.7)
    assert -stiffness * (q - rest) == pytest.approx(torque)


def test_springs_travel_in_files_and_pickles(tmp_path):
    robot = slider(springs={"x": (8.0, 0.5)})
    assert pickle.loads(pickle.dumps(robot)).springs == (("x", 8.0, 0.5),)
    solution = rt.plan(rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort()))
    solution.save(tmp_path / "spring.npz")
    assert rt.load_solution(tmp_path / "spring.npz").problem.phases[0].robot.springs == robot.springs
    assert "Springs pull at x 8 N/m at rest at 0.5 m" in " ".join(str(robot).split())


@pytest.mark.parametrize(
    ("springs", "part"),
    [
        ({"y": 1.0}, "no joint named 'y'"),
        ({"x": -1.0}, "stiffness"),
        ({"x": (1.0, np.nan)}, "stiffness"),
        (3.0, "mapping"),
    ],
)
def test_springs_that_cannot_be(springs, part):
    with pytest.raises(rt.InputError, match=part):
        slider(springs=springs)
