"""Solo12, floating: standing on four feet it sways, on two it trots, in MuJoCo as planned."""

from functools import partial

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait

pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")

pytestmark = pytest.mark.slow
FEET = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")
WEIGHT = 24.53


def calm(weight=1e-2):
    """Effort alone lets light legs whirl."""
    return rt.Effort() + weight * rt.Lagrange(lambda point: ca.sumsqr(point.v[6:]))


def crouched(robot):
    q = np.array(robot.neutral)
    for i, name in enumerate(robot.position_names):
        side = 1.0 if name.startswith("F") else -1.0
        if name.endswith("HFE"):
            q[i] = 0.8 * side
        if name.endswith("KFE"):
            q[i] = -1.6 * side
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    q[2] -= data.oMf[robot.frame("FL_FOOT")].translation[2]
    return q


def test_four_feet_stay_while_the_body_sways():
    solo = rt.load("solo12", root="floating")
    q = crouched(solo)
    sway = rt.Phase(
        solo,
        duration=0.4,
        start=rt.State(q=q, v=0),
        end=rt.State(q={"root_x": q[0] + 0.03, "root_y": q[1] + 0.02, "root_z": q[2] - 0.03}, v=0),
        contacts=[rt.PointContact(foot, friction=0.5, normal_force=(1.0, np.inf)) for foot in FEET],
        objective=calm(),
    )
    solution = rt.plan(sway, mesh=rt.Mesh(6, rt.HermiteSimpson()))
    alone, held = (rt.witness.second_opinion(solution, feedback=f, step=1e-3) for f in (rt.witness.NoFeedback(), None))
    assert alone.completed and held.completed
    assert held.deviation.largest("q.") < 0.01 < alone.deviation.largest("q.")
    assert held.slip < 1e-3 and held.sink < 1e-3
    for foot in held.feet:
        assert foot.stances == 1 and foot.loaded == pytest.approx(1.0, abs=0.02)
        np.testing.assert_allclose(foot.force, foot.planned, atol=0.02 * WEIGHT)


def test_it_trots_on_for_a_dozen_half_strides():
    solo = rt.load("solo12", root="floating", limits={"velocity": 15.0, "effort": 2.7})
    foot = partial(rt.PointContact, friction=0.5, normal_force=(1.0, 60.0))
    # With a smaller weight hind knees that are nearly straight cost least, and no feedback holds them.
    trot = gait.trot(solo, step_length=0.05, duration=0.2, clearance=0.03, contact=foot, objective=calm(3e-2))
    solution = rt.plan(trot, mesh=rt.Mesh(8, rt.HermiteSimpson()))
    assert not rt.witness.second_opinion(solution, feedback=rt.witness.NoFeedback()).upright
    # A ground with a little more friction than the plan uses.
    opinion = rt.witness.second_opinion(solution, periods=12, ground=rt.witness.SoftGround(grip=1.4))
    assert opinion.completed and opinion.upright
    assert opinion.deviation.largest("q.") < 0.1
    q = opinion.simulation.q
    assert q[-1, 0] - q[0, 0] == pytest.approx(12 * 0.05, abs=0.05)
    assert sum(report.force[2] for report in opinion.feet) == pytest.approx(WEIGHT, rel=0.02)
    for report in opinion.feet:
        assert report.stances in (6, 7) and 0.4 < report.loaded < 0.6
        np.testing.assert_allclose(report.force, report.planned, atol=0.03 * WEIGHT)


def test_feet_that_are_set_down_at_rest_delay_no_crawl():
    """A crawl that waits for a foot without a velocity falls over the edge of its tripod."""
    hyq = rt.load("hyq", root="floating")
    crawl = gait.crawl(hyq, step_length=0.2, duration=1.2)
    opinion = rt.witness.second_opinion(rt.plan(crawl, mesh=rt.Mesh(12, rt.HermiteSimpson())))
    assert opinion.completed and opinion.upright
    assert abs(opinion.lag) < 0.02
    assert opinion.deviation.largest("q.") < 0.05
