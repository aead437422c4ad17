"""Plans of legged robots, from URDF to forward simulation, on planar and floating roots."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait

SIDES = {"left_hip": "right_hip", "left_knee": "right_knee", "left_foot": "right_foot"}


@pytest.fixture(scope="module")
def step() -> rt.Solution:
    """The periodic step of the five-link biped: one stance, closed by a mirrored heel strike."""
    robot = rt.load("five_link", root="planar")
    stance = rt.Phase(
        robot,
        duration=0.7,
        contacts=[rt.PointContact("left_foot", friction=0.8)],
        parameters={"left_foot.x": 0.0},
        constraints=[rt.GroundClearance("right_foot", 0.0)],
        objective=rt.Effort(),
        name="step",
    )
    mirror = rt.Mirror(partners=SIDES, displacement={"q.root_x": 0.5})
    return rt.plan(
        rt.Problem([stance], links=[rt.Touchdown(0, 0, repeat=mirror)]), mesh=rt.Mesh(20, rt.schemes.RadauIIA(5))
    )


@pytest.mark.slow
def test_a_step_of_the_five_link_biped_is_simulated_as_planned(step):
    report = rt.validate(step)
    assert report.passed
    (holding,), (impact,), (landing,) = report.holdings, report.impacts, report.landings
    assert report.drift.largest("q.") < 1e-5 and report.drift.largest("v.") < 1e-4
    assert max(holding.slip.value, holding.sink.value) < 1e-8
    assert holding.planned == holding.solved == () and holding.difference.value < 0.05
    # The mirrored heel strike, from the witness's own mass matrix and Jacobian.
    assert impact.momentum.value < 1e-8 and impact.rest.value < 1e-8
    assert impact.solved == pytest.approx(impact.impulses, abs=1e-7)
    assert impact.lost > 10.0
    assert landing.moved < 1e-10


@pytest.mark.slow
def test_an_impulse_of_the_step_that_was_tampered_with_is_found(step):
    (impulses,) = step.impulses
    wrong = replace(step, impulses=({**impulses, "impulse.left_foot.x": impulses["impulse.left_foot.x"] + 0.5},))
    report = rt.validate(wrong)
    assert not report.passed
    assert report.impacts[0].momentum.value == pytest.approx(0.5, abs=1e-6)


@pytest.mark.slow
def test_a_quadruped_on_four_feet_is_simulated_as_planned():
    robot = rt.load("solo12", root="floating")
    feet = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")
    q, data = np.array(robot.neutral), robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    q[2] -= data.oMf[robot.frame("FL_FOOT")].translation[2]
    sway = rt.Phase(
        robot,
        duration=0.3,
        start=rt.State(q=dict(zip(robot.position_names, q, strict=True)), v=0),
        end=rt.State(q={"root_x": q[0] + 0.03, "root_y": q[1] + 0.02, "root_z": q[2] - 0.02}, v=0),
        contacts=[rt.PointContact(foot, friction=0.7) for foot in feet],
        objective=rt.Effort() + rt.Lagrange(lambda point: 0.5 * ca.sumsqr(point.v)),
        name="sway",
    )
    report = rt.validate(rt.plan(sway, mesh=rt.Mesh(24)))
    assert report.passed
    assert {holding.contact for holding in report.holdings} == set(feet)
    assert max(max(h.slip.value, h.sink.value) for h in report.holdings) < 1e-5
    assert max(h.difference.value for h in report.holdings) < 0.05
    assert report.drift.largest("q.") < 1e-3


@pytest.mark.slow
def test_a_robot_on_two_flat_feet_is_simulated_as_planned():
    robot = rt.load("talos_legs", root="floating")
    soles = ("left_sole_link", "right_sole_link")

    def foot(frame: str) -> rt.FlatFoot:
        return rt.FlatFoot(frame, length=0.2, width=0.1, friction=0.6)

    here = dict(zip(robot.position_names, gait.stand(robot, soles, contact=foot), strict=True))
    squat = rt.Phase(
        robot,
        duration=0.6,
        start=rt.State(q=here, v=0),
        end=rt.State(q={"root_z": here["root_z"] - 0.05, "root_y": here["root_y"] + 0.04}, v=0),
        contacts=[foot(sole) for sole in soles],
        objective=1e-3 * rt.Effort() + rt.Lagrange(lambda point: ca.sumsqr(point.v)),
        name="squat",
    )
    report = rt.validate(rt.plan(squat, mesh=rt.Mesh(12)))
    assert report.passed
    for holding in report.holdings:
        assert max(holding.slip.value, holding.sink.value, holding.turn.value) < 5e-5
        assert holding.difference.value < 5e-3 * holding.weight
