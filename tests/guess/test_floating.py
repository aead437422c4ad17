"""Guesses for floating roots: unit quaternions, body velocities that are their rates, and the given ends."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.guess.perturbed import Perturbed
from robotraj.robot import tangent

STEP = 1e-5
INSIDE = np.array([0.1, 0.3, 0.45, 0.8])


@pytest.fixture(scope="module")
def robot():
    return rt.load("cartpole", root="floating")


@pytest.fixture(scope="module")
def poses(robot):
    rng = np.random.default_rng(2)
    return [pin.integrate(robot.model, robot.neutral, 0.8 * rng.normal(size=robot.nv)) for _ in range(3)]


@pytest.fixture(scope="module")
def phase(robot, poses):
    return rt.Phase(robot, 0.5, start=rt.State(q=poses[0], v=0.3), end=rt.State(q=poses[1]), limits=None)


@pytest.fixture(
    params=["straight", "keyframes", "minimum jerk", "waypoint", "perturbed", "inverse kinematics"], scope="module"
)
def guess(request, phase, poses):
    keys = [rt.State(q=q) for q in (poses[0], poses[2], poses[1])]
    if request.param == "inverse kinematics":
        phase = rt.Phase(phase.robot, 0.5, start=phase.start, limits=None)
    return {
        "straight": lambda: rt.guess.StraightLine(),
        "keyframes": lambda: rt.guess.Keyframes([0, 0.4, 1], keys),
        "minimum jerk": lambda: rt.guess.MinimumJerk(),
        "waypoint": lambda: rt.guess.MinimumJerk(waypoints=[poses[2]], fractions=[0, 0.4, 1]),
        "perturbed": lambda: Perturbed(rt.guess.MinimumJerk(), (4,)),
        "inverse kinematics": lambda: rt.guess.InverseKinematics("tip", [0.4, 0.1, 0.2]),
    }[request.param]().of(phase, 0)


def positions(robot, guess, s):
    return guess.states(s)[:, : robot.nq]


def test_quaternions_have_length_1(robot, guess):
    q = positions(robot, guess, np.linspace(0, 1, 21))
    np.testing.assert_allclose(np.linalg.norm(q[:, 3:7], axis=1), 1.0, atol=1e-12)


def test_velocities_are_the_rates_of_the_positions(robot, guess):
    gap = tangent.difference(
        robot.model, positions(robot, guess, INSIDE - STEP), positions(robot, guess, INSIDE + STEP)
    )
    expected = gap / (2 * STEP * guess.duration)
    np.testing.assert_allclose(guess.states(INSIDE)[:, robot.nq :], expected, atol=1e-5)


def test_the_ends_are_met(robot, guess, poses, request):
    ends = positions(robot, guess, np.array([0.0, 1.0]))
    np.testing.assert_allclose(ends[0], poses[0], atol=1e-12)
    if "inverse kinematics" not in request.node.name:
        np.testing.assert_allclose(ends[1], poses[1], atol=1e-12)


def test_minimum_jerk_has_the_torques_of_its_motion(robot, phase):
    guess = rt.guess.MinimumJerk().of(phase, 0)
    model, data = robot.model, robot.model.createData()
    x, h = guess.states(INSIDE), STEP * guess.duration
    v = x[:, robot.nq :]
    a = (guess.states(INSIDE + STEP) - guess.states(INSIDE - STEP))[:, robot.nq :] / (2 * h)
    np.testing.assert_allclose(guess.algebraic(INSIDE)[:, : robot.nv], a, atol=1e-5)
    needed = [
        pin.rnea(model, data, q, w, b) + robot.dissipation(w)
        for q, w, b in zip(x[:, : robot.nq], v, guess.algebraic(INSIDE)[:, : robot.nv], strict=True)
    ]
    np.testing.assert_allclose(guess.controls(INSIDE), np.array(needed) @ robot.actuation, rtol=1e-9)


def test_inverse_kinematics_keep_a_root_that_is_fixed(robot):
    start = rt.State(q=robot.neutral, v=0)
    end = rt.State(q=dict(zip(robot.position_names[:7], robot.neutral[:7], strict=True)))
    phase = rt.Phase(robot, 0.5, start=start, end=end, limits=None)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, np.append(robot.neutral[:7], [0.4, 0.6]))
    target = data.oMf[robot.frame("tip")].translation.copy()
    guess = rt.guess.InverseKinematics("tip", target).of(phase, 0)
    last = positions(robot, guess, np.array([1.0]))[0]
    np.testing.assert_allclose(last[:7], robot.neutral[:7], atol=1e-12)
    pin.framesForwardKinematics(robot.model, data, last)
    np.testing.assert_allclose(data.oMf[robot.frame("tip")].translation, target, atol=1e-7)


def test_a_free_quaternion_at_the_end_is_that_of_the_start(robot, poses):
    phase = rt.Phase(robot, 0.5, start=rt.State(q=poses[0]), end=rt.State(q={"root_x": 1.0}), limits=None)
    last = positions(robot, rt.guess.StraightLine().of(phase, 0), np.array([1.0]))[0]
    np.testing.assert_allclose(last, [1.0, *poses[0][1:]], atol=1e-12)
