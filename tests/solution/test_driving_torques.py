"""Torques by inverse dynamics along a motion, the damping and the friction of the joints among them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.trajectory import PiecewisePolynomial
from robotraj.solution.driving_torques import DrivingTorques


def test_a_rod_that_swings_needs_inertia_weight_damping_and_friction() -> None:
    """q = t^2 / 2: tau = I + m g l sin q + d t + F tanh(t / v_s) of a rod of one joint."""
    robot = rt.load("pendulum")
    sites = np.array([0.0, 0.5, 1.0])
    x = PiecewisePolynomial(np.array([0.0, 1.0]), [sites], [np.stack([0.5 * sites**2, sites], axis=1)])
    torques = DrivingTorques(robot, x)
    still = PiecewisePolynomial(np.array([0.0, 1.0]), [sites], [np.zeros((3, 2))])
    rest = DrivingTorques(robot, still)(0.0)
    t = np.linspace(0.0, 1.0, 7)
    tau = torques(t)[:, 0]
    model, data = robot.model, robot.model.createData()
    for time, value in zip(t, tau, strict=True):
        q, v = np.array([0.5 * time**2]), np.array([time])
        mass, bias = pin.crba(model, data, q)[0, 0], pin.nonLinearEffects(model, data, q, v)[0]
        drag = robot.damping[0] * time + robot.friction[0] * np.tanh(time / robot.friction_speed)
        assert value == pytest.approx(mass + bias + drag, rel=1e-12)
    assert rest == pytest.approx(pin.computeGeneralizedGravity(model, data, np.zeros(1)), abs=1e-12)


def test_times_and_places_inside_intervals_agree() -> None:
    robot = rt.load("ur5")
    solution = rt.plan(rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort()), mesh=rt.Mesh(4))
    (part,) = solution.phases
    torques = part.torques
    assert torques is not None
    places = np.array([0.25, 0.5, 0.75])
    times = part.knots[:-1, None] + np.diff(part.knots)[:, None] * places
    assert torques.inside(places).reshape(-1, 6) == pytest.approx(torques(times.ravel()), abs=1e-9)
    assert part.at(0.3).tau == pytest.approx(torques(0.3), abs=1e-12)
    assert part.at(0.3).u["tau.elbow_joint"] == pytest.approx(part.at(0.3).tau[2], abs=1e-12)
