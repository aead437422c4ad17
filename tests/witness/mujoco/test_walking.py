"""The five-link biped's step, periodic by a mirror and an impact, followed by MuJoCo for many steps."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from tests.robots.kelly2017 import five_link_map

pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")

STEP, DURATION = 0.4, 0.6
FIRST = np.array([-0.3, 0.7, 0.0, -0.5, -0.6])
"""Absolute angles of a stride, from the standing tibia to the swinging one."""


def standing(biped, angles):
    """State with the left foot at the origin."""
    q = np.concatenate([np.zeros(2), five_link_map("left") @ angles])
    data = biped.model.createData()
    pin.framesForwardKinematics(biped.model, data, q)
    q[:2] -= data.oMf[biped.frame("left_foot")].translation[[0, 2]]
    return rt.State(q=q)


@pytest.fixture(scope="module")
def walk():
    biped = rt.load("five_link", root="planar")
    sides = {"left_hip": "right_hip", "left_knee": "right_knee", "left_foot": "right_foot"}
    step = rt.Phase(
        biped,
        duration=DURATION,
        contacts=[rt.PointContact("left_foot", friction=0.8)],
        parameters={"left_foot.x": 0.0},
        constraints=[rt.GroundClearance("right_foot", rt.constraints.SwingApex(0.03, -STEP, STEP))],
        objective=rt.Effort(),
        name="step",
    )
    mirror = rt.Mirror(partners=sides, displacement={"q.root_x": STEP})
    problem = rt.Problem([step], links=[rt.Touchdown(0, 0, repeat=mirror)])
    guess = rt.guess.Keyframes([0, 1], [standing(biped, FIRST), standing(biped, FIRST[::-1])])
    return rt.plan(problem, mesh=rt.Mesh(12, rt.HermiteSimpson()), guess=guess)


def test_it_falls_without_feedback_and_walks_on_with_it(walk):
    alone = rt.witness.second_opinion(walk, feedback=rt.witness.NoFeedback())
    assert alone.periods == 3 and alone.fell is not None and not alone.completed
    opinion = rt.witness.second_opinion(walk, periods=6)
    assert opinion.completed and opinion.upright
    assert opinion.simulation.q[-1, 0] - opinion.simulation.q[0, 0] == pytest.approx(6 * STEP, abs=0.1)
    assert opinion.deviation["q.root_pitch"].largest < 0.05
    assert abs(opinion.lag) < 0.1
    assert opinion.slip < 0.02 and opinion.sink < 5e-3


def test_feet_take_turns_and_carry_the_weight(walk):
    left, right = rt.witness.second_opinion(walk, periods=4).feet
    assert (left.name, right.name) == ("left_foot", "right_foot")
    for foot in (left, right):
        assert foot.stances in (2, 3) and 0.4 < foot.loaded < 0.6
        # The mean forces of MuJoCo's ground are those of the plan, impacts included.
        assert foot.force[2] == pytest.approx(foot.planned[2], rel=0.05)
    weight = 9.81 * sum(inertia.mass for inertia in walk.phases[0].phase.robot.model.inertias)
    assert left.force[2] + right.force[2] == pytest.approx(weight, rel=0.02)


def test_a_push_is_recovered(walk):
    push = np.zeros(14)
    push[7] = 0.1
    opinion = rt.witness.second_opinion(walk, periods=5, offset=push)
    assert opinion.completed
    assert opinion.deviation["q.root_pitch"].final < 0.05


@pytest.mark.slow
def test_it_climbs_stairs():
    rise, depth = 0.05, 0.3
    stairs = rt.terrain.Steps([(k + 0.3) * depth for k in range(-4, 12)], [(k - 3) * rise for k in range(17)])
    biped = rt.load("five_link", root="planar")
    upwards = gait.mirror(biped, displacement={"q.root_x": depth, "q.root_z": rise})
    step = gait.walk(biped, step_length=depth, duration=0.7, clearance=0.03, ground=stairs, repeat=upwards)
    opinion = rt.witness.second_opinion(rt.plan(step, mesh=rt.Mesh(14, rt.HermiteSimpson())), periods=6)
    assert opinion.completed
    assert opinion.deviation.largest("q.") < 0.05
    assert opinion.simulation.q[-1, 1] - opinion.simulation.q[0, 1] == pytest.approx(6 * rise, abs=0.01)
