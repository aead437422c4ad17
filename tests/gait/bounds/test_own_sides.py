"""Feet keep to their own sides by default, and the witness notices legs that cross."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.sides.foot_pairs import foot_pairs
from robotraj.robot.sides.images import places_of

FEET = ("FL_FOOT", "FR_FOOT")
SOLO = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")


@pytest.fixture(scope="module")
def bolt() -> rt.Robot:
    return rt.load("bolt", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})


def step(bolt: rt.Robot, **more: Any) -> rt.Solution:
    foot = partial(rt.PointContact, friction=0.6)
    problem = rt.gait.walk(bolt, feet=FEET, contact=foot, step_length=0.06, duration=0.2, clearance=0.03, **more)
    return rt.plan(problem, progress=False)


def lateral(solution: rt.Solution) -> np.ndarray:
    """The left foot's y minus the right one's along a plan [m]."""
    robot = solution.phases[0].phase.robot
    places = []
    for t in np.linspace(0.0, solution.duration, 80):
        s = solution.at(float(t))
        point = rt.witness.NumericPoint(robot, t, s.q, s.v, s.a, s.tau)
        places.append(point.frame(FEET[0]).position[1] - point.frame(FEET[1]).position[1])
    return np.array(places)


def test_the_default_walk_keeps_the_left_foot_on_the_left(bolt: rt.Robot) -> None:
    solution = step(bolt)
    assert solution.proof.holds and lateral(solution).min() > 0.02
    report = rt.validate(solution)
    assert report.passed
    assert 0.024 < min(order.distance for order in report.foot_orders) < 0.03


@pytest.mark.slow
def test_crossed_legs_are_noticed(bolt: rt.Robot) -> None:
    solution = step(bolt, sides=None)
    assert lateral(solution).max() < 0.0
    report = rt.validate(solution)
    assert not report.passed
    assert any(sentence.startswith("Legs cross: ") for sentence in report.failures(report.tolerances))


def widths(problem: rt.Problem) -> list[float]:
    return [row.lower for phase in problem.phases for row in phase.rows if row.name == "own sides"]


def test_the_width_is_that_of_the_soles_and_a_share_of_the_gap_between_them() -> None:
    robot = rt.load("talos_legs", root="floating")
    feet = ("left_sole_link", "right_sole_link")
    sole = rt.FlatFoot(feet[0], length=0.2, width=0.1)
    posture = rt.gait.stand(robot, feet, sole)
    (pair,) = foot_pairs(robot, feet, posture)
    assert pair.distance == pytest.approx(0.17, abs=1e-3)
    make = partial(rt.gait.walk, robot, step_length=0.2, duration=0.8, feet=feet, contact=sole, repeat=rt.Periodic())
    for share in (0.0, 0.5, 1.0):
        (width, again) = widths(make(sides=rt.gait.OwnSides(share)))
        assert width == again == pytest.approx(0.1 + share * (pair.distance - 0.1))
    assert not widths(make(sides=None))


def test_quadrupeds_have_two_pairs_and_planar_bipeds_none() -> None:
    solo = rt.load("solo12", root="floating")
    assert len(widths(rt.gait.trot(solo, step_length=0.05, duration=0.2))) == 2
    assert not widths(rt.gait.walk(rt.load("five_link", root="planar"), step_length=0.4, duration=0.6))


@pytest.mark.parametrize(("root", "count"), [("planar", 2), ("floating", 4)])
def test_legs_of_one_plane_keep_their_order_along_it(root: str, count: int) -> None:
    """solo8 has no joint that moves a leg aside; solo12 has."""
    solo = rt.load("solo8", root=root)
    pairs = foot_pairs(solo, SOLO, solo.neutral)
    assert len(pairs) == count
    ahead = [pair for pair in pairs if pair.across[0] ** 2 > 0.99]
    assert sorted((pair.first, pair.second) for pair in ahead) == [("FL_FOOT", "HL_FOOT"), ("FR_FOOT", "HR_FOOT")]
    np.testing.assert_allclose([pair.distance for pair in ahead], 0.38, atol=1e-6)


def test_turning_a_robot_in_its_root_turns_the_axis_of_a_pair() -> None:
    solo = rt.load("solo8", root="planar", base=((0, 0, 0), (0, 0, 1, 0)))
    places = places_of(solo, solo.neutral)
    for pair in foot_pairs(solo, SOLO, solo.neutral):
        assert (places[pair.first] - places[pair.second]) @ np.array(pair.across) == pytest.approx(pair.distance)


@pytest.mark.slow
def test_a_hind_leg_in_the_plane_of_a_front_one_does_not_pass_it() -> None:
    limits = {"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7}
    solo = rt.load("solo8", root="planar", limits=limits)
    planned = [
        rt.plan(rt.gait.crawl(solo, step_length=0.1, duration=0.8, **sides), progress=False)
        for sides in ({}, {"sides": None})
    ]
    assert planned[0].proof.holds and not planned[1].proof.holds
    orders = [min(order.distance for order in rt.validate(each).foot_orders) for each in planned]
    assert orders[0] > 0.19 - 1e-4 and orders[1] < 0.0


def test_phases_that_hold_both_feet_have_no_row(bolt: rt.Robot) -> None:
    problem = rt.gait.jump(bolt, feet=FEET)
    named = [phase.name for phase in problem.phases if any(row.name == "own sides" for row in phase.rows)]
    assert named == ["flight"]


@pytest.mark.parametrize("angle", [0.5, 2.8])
def test_the_footholds_of_a_turn_satisfy_the_row(bolt: rt.Robot, angle: float) -> None:
    problem = rt.gait.turn(bolt, angle=angle, feet=FEET)
    assert all(0.0 < width <= 0.5 * 0.052 for width in widths(problem))


@pytest.mark.parametrize("share", [-0.1, 1.1])
def test_a_share_outside_its_range_is_refused(share: float) -> None:
    with pytest.raises(rt.InputError, match="share"):
        rt.gait.OwnSides(share)
