"""A robot on a path: its motion is Pinocchio's, and its rates are derivatives of the motion in time."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from scipy.interpolate import CubicSpline

import robotraj as rt
from robotraj.applications import as_path
from robotraj.dynamics.path_body import PathBody, values_on

RNG = np.random.default_rng(4)
PATH = as_path(CubicSpline(np.linspace(0.0, 2.0, 6), RNG.uniform(-1.0, 1.0, (6, 6))))
S, SPEED, ACCELERATION, JERK = 0.83, 1.3, -2.1, 4.7
STEP = 1e-4


@pytest.fixture(scope="module")
def body():
    return PathBody(rt.load("ur5"), path=PATH)


def evaluated(body, outputs, s=S, speed=SPEED, acceleration=ACCELERATION):
    """Evaluate functions of a point and of s''' at one state."""
    x, u, rate = ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("rate")
    point = body.point(ca.SX(0), x, ca.SX(0, 1), u, ca.SX(0, 1), [])
    function = ca.Function("values", [x, u, rate], [ca.vertcat(value) for value in outputs(point, rate)])
    return [np.array(value).ravel() for value in function.call([[s, speed], acceleration, JERK])]


def moved(t):
    """s, s' and s'' of a motion with a constant s'''."""
    s = S + SPEED * t + ACCELERATION * t**2 / 2 + JERK * t**3 / 6
    return s, SPEED + ACCELERATION * t + JERK * t**2 / 2, ACCELERATION + JERK * t


def test_values_on_a_path_are_those_of_its_polynomials_on_both_sides_of_a_break():
    s = ca.SX.sym("s")
    function = ca.Function("path", [s], values_on(PATH, s))
    curves = [PATH]
    for _ in range(3):
        curves.append(curves[-1].derivative())
    for at in (0.0, 0.399, 0.401, 1.234, 2.0):
        for value, curve in zip(function.call([at]), curves, strict=True):
            assert np.allclose(np.array(value).ravel(), curve(at), rtol=1e-9, atol=1e-9)


def test_torques_on_a_path_are_those_of_pinocchio_with_damping(body):
    robot = body.robot
    q, v, a, tau = evaluated(body, lambda point, rate: (point.q, point.v, point.a, point.tau))
    assert np.allclose(q, PATH(S)) and np.allclose(v, PATH.derivative()(S) * SPEED)
    assert np.allclose(tau, pin.rnea(robot.model, robot.model.createData(), q, v, a) + robot.dissipation(v))


def test_accelerations_jerks_and_torque_rates_are_derivatives_in_time(body):
    def motion(point, rate):
        return point.v, point.a, point.tau

    def rates(point, rate):
        return point.a, body.jerk(point, rate), body.torque_rate(point, rate)

    before, after = (evaluated(body, motion, *moved(t)) for t in (-STEP, STEP))
    for low, high, rate in zip(before, after, evaluated(body, rates), strict=True):
        assert np.allclose((high - low) / (2 * STEP), rate, rtol=1e-5, atol=1e-4 * np.abs(rate).max())


def test_a_point_has_the_names_of_a_robot_without_a_path(body):
    joint = body.robot.actuated[2]
    found = evaluated(
        body, lambda point, rate: (point.x[f"q.{joint}"] - point.q[2], point.u[f"tau.{joint}"] - point.tau[2])
    )
    assert np.allclose(found, 0.0)


def test_joints_without_motors_and_paths_of_other_joints_are_refused():
    with pytest.raises(rt.InputError, match="motor at every joint"):
        PathBody(rt.load("acrobot", actuated=["elbow"]), path=as_path(np.array([[0.0, 0.0], [1.0, 1.0]])))
    with pytest.raises(rt.InputError, match="6 joints"):
        PathBody(rt.load("double_pendulum"), path=PATH)
