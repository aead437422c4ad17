"""Bolt, with two point feet, walks in space: it cannot stand still, and MuJoCo tracks its steps."""

from functools import partial

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj import gait

pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")


@pytest.mark.slow
def test_bolt_walks_on_point_feet():
    bolt = rt.load("bolt", root="floating", limits={"velocity": 15.0, "effort": 2.7})
    calm = rt.Effort() + 1e-2 * rt.Lagrange(lambda point: ca.sumsqr(point.v[6:]))
    foot = partial(rt.PointContact, friction=0.5, normal_force=(0.0, 60.0))
    step = gait.walk(bolt, step_length=0.05, duration=0.3, clearance=0.03, contact=foot, objective=calm)
    solution = rt.plan(step, mesh=rt.Mesh(10, rt.HermiteSimpson()))
    assert not rt.witness.second_opinion(solution, feedback=rt.witness.NoFeedback()).upright
    opinion = rt.witness.second_opinion(solution, periods=8)
    assert opinion.completed and opinion.upright
    assert opinion.deviation.largest("q.") < 0.1
    assert opinion.slip < 5e-3 and opinion.sink < 5e-3
    q = opinion.simulation.q
    assert q[-1, 0] - q[0, 0] == pytest.approx(8 * 0.05, abs=0.05)
    # Left and right take turns: the sideways push of one foot is the other's, mirrored.
    left, right = opinion.feet
    np.testing.assert_allclose(left.force, left.planned, atol=0.5)
    np.testing.assert_allclose(left.force * [1, -1, 1], right.force, atol=0.5)
