"""Robots as DAEs: rates and residuals against plain Pinocchio, damping and friction included."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.problem.constraints.base import symbols_of


def evaluate(dae: Any, expression: Any, q: Any, v: Any, a: Any, tau: Any) -> np.ndarray:
    """An expression of the dynamics' point, at numbers."""
    point = symbols_of(dae, ())
    value = expression(point)
    inputs = [ca.vertcat(*point.x.values()), ca.vertcat(*point.u.values())]
    numbers = [np.concatenate([q, v]), tau]
    if dae.algebraic:
        inputs.append(ca.vertcat(*point.z.values()))
        numbers.append(a)
    return ca.Function("f", inputs, [ca.SX(value)])(*numbers).full().ravel()


@pytest.fixture(params=["cartpole", "acrobot", "pendulum", "ur5"])
def robot(request: pytest.FixtureRequest) -> rt.Robot:
    return rt.load(request.param)


def somewhere(robot: rt.Robot) -> tuple[np.ndarray, ...]:
    random = np.random.default_rng(5)
    return tuple(random.uniform(-1, 1, n) for n in (robot.nv, robot.nv, robot.nv, robot.nu))


def acceleration(robot: rt.Robot, q: Any, v: Any, tau: Any) -> np.ndarray:
    """Return the acceleration of Pinocchio's ABA under B tau - dissipation."""
    return pin.aba(robot.model, robot.model.createData(), q, v, robot.actuation @ tau - robot.dissipation(v))


def test_forward_dynamics_are_abas(robot: rt.Robot) -> None:
    q, v, a, tau = somewhere(robot)
    dae = rt.dynamics.ForwardDynamics().of(robot)
    found = evaluate(dae, dae.rates, q, v, a, tau)
    np.testing.assert_allclose(found, np.concatenate([v, acceleration(robot, q, v, tau)]), rtol=1e-9, atol=1e-9)
    assert dae.algebraic == dae.residuals == ()


def test_the_residual_of_inverse_dynamics_vanishes_at_abas_acceleration_alone(robot: rt.Robot) -> None:
    q, v, a, tau = somewhere(robot)
    dae = rt.dynamics.InverseDynamics().of(robot)
    found = evaluate(dae, dae.residual, q, v, acceleration(robot, q, v, tau), tau)
    np.testing.assert_allclose(found, 0, atol=1e-8)
    mass = pin.crba(robot.model, robot.model.createData(), q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    expected = mass @ (a - acceleration(robot, q, v, tau))
    np.testing.assert_allclose(evaluate(dae, dae.residual, q, v, a, tau), expected, rtol=1e-8, atol=1e-8)
    np.testing.assert_array_equal(evaluate(dae, dae.rates, q, v, a, tau), np.concatenate([v, a]))


def test_damping_and_friction_oppose_the_motion() -> None:
    robot = rt.load("pendulum")
    assert robot.damping[0] == pytest.approx(0.1)
    dae = rt.dynamics.InverseDynamics().of(robot)
    still = evaluate(dae, dae.residual, [0.3], [0.0], [0.0], [0.0])
    moving = evaluate(dae, dae.residual, [0.3], [2.0], [0.0], [0.0])
    np.testing.assert_allclose(moving - still, robot.dissipation(np.array([2.0])), atol=1e-12)


def test_variables_are_named_by_joint_with_units() -> None:
    dae = rt.dynamics.InverseDynamics().of(rt.load("cartpole"))
    assert [(v.name, v.unit) for v in dae.states] == [
        ("q.slider", "m"),
        ("q.pole", "rad"),
        ("v.slider", "m/s"),
        ("v.pole", "rad/s"),
    ]
    assert [(v.name, v.unit) for v in dae.algebraic] == [("a.slider", "m/s^2"), ("a.pole", "rad/s^2")]
    assert [(v.name, v.unit) for v in dae.controls] == [("tau.slider", "N")]
    assert [(v.name, v.unit) for v in dae.residuals] == [("dynamics.slider", "N"), ("dynamics.pole", "N m")]


def test_a_point_has_frames_centre_of_mass_and_momentum() -> None:
    robot = rt.load("acrobot")
    q, v, a, tau = somewhere(robot)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q, v, a)
    pin.updateFramePlacements(robot.model, data)
    pin.centerOfMass(robot.model, data, q)
    pin.ccrba(robot.model, data, q, v)
    frame = robot.frame("tip")
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    dae = rt.dynamics.InverseDynamics().of(robot)
    expected = {
        "position": data.oMf[frame].translation,
        "velocity": pin.getFrameVelocity(robot.model, data, frame, axes).vector,
        "acceleration": pin.getFrameClassicalAcceleration(robot.model, data, frame, axes).vector,
    }
    for name, value in expected.items():
        found = evaluate(dae, lambda point, name=name: getattr(point.frame("tip"), name), q, v, a, tau)
        np.testing.assert_allclose(found, value, atol=1e-10)
    np.testing.assert_allclose(evaluate(dae, lambda point: point.com, q, v, a, tau), data.com[0], atol=1e-12)
    np.testing.assert_allclose(evaluate(dae, lambda point: point.momentum, q, v, a, tau), data.hg.vector, atol=1e-12)
