"""Bolt, a biped on two points, walks: planned from the built-in guess, proved by simulation, followed by MuJoCo."""

from __future__ import annotations

from functools import partial

import pytest

import robotraj as rt
from tests.robots.walkers import (
    apex,
    assert_cones_hold,
    assert_it_is_proved,
    assert_it_repeats_mirrored,
    assert_the_ground_carries_the_weight,
    objective,
)

pytestmark = pytest.mark.slow

FRICTION = 0.6


@pytest.fixture(scope="module")
def walk(bolt: rt.Robot) -> rt.Solution:
    foot = partial(rt.PointContact, friction=FRICTION)
    step = rt.gait.walk(
        bolt, step_length=0.06, duration=0.2, clearance=0.03, contact=foot, objective=objective(bolt, foot)
    )
    return rt.plan(step, mesh=rt.Mesh(6, rt.schemes.LobattoIIIA(4)))


def test_a_step_is_planned_and_proved(walk: rt.Solution) -> None:
    assert_it_is_proved(walk)
    assert_cones_hold(walk, FRICTION)


def test_a_step_repeats_mirrored_at_its_length(walk: rt.Solution) -> None:
    assert_it_repeats_mirrored(walk, {"FL": "FR"})
    ends = walk.at(0.0).q, walk.at(walk.duration).q
    assert ends[1][0] - ends[0][0] == pytest.approx(0.06, abs=1e-8)
    assert apex(walk, "FR_FOOT") > 0.029


def test_the_ground_carries_the_weight(walk: rt.Solution) -> None:
    assert_the_ground_carries_the_weight(walk)


def test_mujoco_walks_six_steps(walk: rt.Solution) -> None:
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    opinion = rt.witness.second_opinion(walk, periods=6)
    assert opinion.completed and opinion.upright
    assert opinion.simulation.q[-1, 0] - opinion.simulation.q[0, 0] == pytest.approx(6 * 0.06, abs=0.03)
