"""Feet that cannot move independently, and the plane in which their robot is planned."""

from __future__ import annotations

import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from tests.programs import nlp_of

LIMITS = {"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7}


@pytest.fixture
def solo8() -> rt.Robot:
    return rt.load("solo8", root="floating", limits=LIMITS)


def assert_level(problem: rt.Problem) -> None:
    """The root is level where feet of both sides stand."""
    for phase in problem.phases:
        across = len({contact.frame[:2] for contact in phase.contacts}) > 2
        assert (phase.states.get("q.root_qx") == 0.0) == across


@pytest.mark.slow
def test_legs_in_parallel_planes_hold_the_root_level_on_both_sides(solo8: rt.Robot) -> None:
    """The distance of left and right footholds is stationary at a level root: without a row for it no plan is found."""
    problem = rt.gait.start_stop(solo8, step_length=0.05, count=2)
    assert_level(problem)
    solution = rt.plan(problem)
    assert solution.proof is not None and solution.proof.holds


def test_a_crawl_on_legs_in_parallel_planes_meets_its_rows_within_a_hundred_iterations(solo8: rt.Robot) -> None:
    problem = rt.gait.crawl(solo8, step_length=0.03, duration=0.5)
    assert_level(problem)
    nlp = nlp_of(problem, rt.Mesh(4))
    outcome = rt.InteriorPoint(max_iterations=100, fallback=None).solve(nlp)
    values = nlp.values(outcome.w)
    assert np.maximum(nlp.rows.lower - values, values - nlp.rows.upper).max() < 1e-6


def test_pairs_of_feet_step_differently_far(solo8: rt.Robot) -> None:
    """The last configuration, whose legs differ, is level too."""
    q = rt.gait.stand(solo8)
    data = solo8.model.createData()
    pin.framesForwardKinematics(solo8.model, data, q)
    lengths = {"FL_FOOT": 0.03, "HR_FOOT": 0.03, "FR_FOOT": 0.05, "HL_FOOT": 0.05}
    home = {foot: data.oMf[solo8.frame(foot)].translation for foot in lengths}
    places = {foot: (home[foot][0] + length, home[foot][1]) for foot, length in lengths.items()}
    pairs = [{f: places[f] for f in pair} for pair in (("FL_FOOT", "HR_FOOT"), ("FR_FOOT", "HL_FOOT"))]
    solution = rt.plan(rt.gait.steps(solo8, pairs))
    assert solution.proof is not None and solution.proof.holds
    pin.framesForwardKinematics(solo8.model, data, solution.at(solution.duration).q)
    for foot, place in places.items():
        assert data.oMf[solo8.frame(foot)].translation == pytest.approx([*place, 0.0], abs=1e-5)


@pytest.mark.parametrize("what", ["turn", "sidestep"])
def test_legs_in_parallel_planes_step_forwards_and_backwards_only(solo8: rt.Robot, what: str) -> None:
    with pytest.raises(rt.InputError, match="after step 1: its legs move in parallel planes"):
        rt.gait.turn(solo8, angle=0.1) if what == "turn" else rt.gait.sidestep(solo8, distance=-0.02)


def test_feet_that_move_independently_are_not_warned_of() -> None:
    solo8, solo12 = (rt.load(name, root="floating") for name in ("solo8", "solo12"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.gait.trot(solo8, step_length=0.05, duration=0.2)
        rt.gait.crawl(solo12, step_length=0.03, duration=0.5)
        rt.gait.start_stop(solo12, step_length=0.05, count=2)


def test_a_quadruped_steps_in_a_plane() -> None:
    """Its feet have no y there, but they still form two diagonal pairs."""
    solo8 = rt.load("solo8", root="planar", limits=LIMITS)
    problem = rt.gait.start_stop(solo8, step_length=0.05, count=2)
    standing = [frozenset(contact.frame for contact in phase.contacts) for phase in problem.phases]
    pairs = {feet for feet in standing if len(feet) == 2}
    assert pairs == {frozenset({"FL_FOOT", "HR_FOOT"}), frozenset({"FR_FOOT", "HL_FOOT"})}
    solution = rt.plan(problem)
    assert solution.proof is not None and solution.proof.holds
    assert solution.at(solution.duration).q[0] - solution.at(0.0).q[0] == pytest.approx(0.05, abs=1e-6)


@pytest.mark.slow
def test_feet_across_the_planes_of_the_legs_leave_a_force_open_and_the_plan_is_proved(solo8: rt.Robot) -> None:
    """A bound on pairs of fore and hind feet: what a tiny singular value divides is no error and no force."""
    pairs = (("FL_FOOT", "FR_FOOT"), ("HL_FOOT", "HR_FOOT"))
    supports = [rt.gait.Support(feet, 0.22, name) for feet, name in zip(pairs, ("fore", "hind"), strict=True)]
    terms = rt.gait.GaitTerms(rt.PointContact("FL_FOOT", friction=0.6), clearance=0.0, upright=rt.gait.Upright())
    bound = rt.gait.sequence(solo8, supports, terms, rt.Periodic(displacement={"q.root_x": 0.08}))
    solution = rt.plan(bound)
    assert solution.proof is not None and solution.proof.holds
    report = rt.validate(solution)
    assert report.passed
    assert all(holding.shared and holding.force_error < 1e-3 and not holding.solved for holding in report.holdings)
