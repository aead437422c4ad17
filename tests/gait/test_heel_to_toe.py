"""Walks whose feet roll over heel and toe: the order of their supports, and the foot's pitch in each."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.witness.mujoco.feet import feet_of, landing_feet
from robotraj.witness.mujoco.reference_motion import ReferenceMotion

SOLE = partial(rt.FlatFoot, length=(0.08, 0.12), width=0.12)


FEET = ("left_sole_link", "right_sole_link")


@pytest.fixture(scope="module")
def robot() -> rt.Robot:
    return rt.load("talos_legs", root="floating")


@pytest.fixture(scope="module")
def walk(robot: rt.Robot) -> rt.Problem:
    repeat = rt.gait.mirror(robot, imbalance=0.05)
    return rt.gait.heel_to_toe(robot, step_length=0.3, duration=0.8, contact=SOLE, repeat=repeat)


def test_each_foot_stands_on_its_heel_then_its_sole_then_its_toe(walk: rt.Problem) -> None:
    kinds = [{c.label: type(c).__name__ for c in phase.contacts} for phase in walk.phases]
    assert kinds == [
        {"left_sole_link": "LineContact", "right_sole_link": "LineContact"},
        {"left_sole_link": "FlatFoot"},
        {"left_sole_link": "LineContact"},
    ]
    offsets = [[c.offset for c in phase.contacts] for phase in walk.phases]
    assert offsets[0] == [(-0.08, 0.0, 0.0), (0.12, 0.0, 0.0)]
    assert offsets[2] == [(0.12, 0.0, 0.0)]
    assert [phase.duration for phase in walk.phases] == pytest.approx([0.16, 0.32, 0.32])


@pytest.mark.filterwarnings("ignore:The inertia of")
def test_soles_and_shares_are_asked_for(robot: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="needs soles, but contact= gives PointContact"):
        rt.gait.heel_to_toe(robot, step_length=0.3, duration=0.8, contact=rt.PointContact)
    with pytest.raises(rt.InputError, match="give three fractions"):
        rt.gait.heel_to_toe(robot, step_length=0.3, duration=0.8, contact=SOLE, shares=(0.5, 0.5))


def pitch(robot: rt.Robot, q: np.ndarray, frame: str) -> float:
    """Angle by which the foot's toe is lower than its heel [rad]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return float(np.arcsin(-data.oMf[robot.frame(frame)].rotation[2, 0]))


@pytest.mark.slow
def test_the_foot_comes_down_and_rolls_over_its_toe(robot: rt.Robot) -> None:
    with pytest.warns(UserWarning, match="not symmetric"):
        problem = rt.gait.heel_to_toe(robot, step_length=0.3, duration=0.8, contact=SOLE)
    solution = rt.plan(problem)
    assert solution.success
    assert rt.validate(solution).passed
    first, flat, toe = solution.phases[:3]
    left = "left_sole_link"
    ends = [pitch(robot, part.at(t).q, left) for part in (first, flat, toe) for t in (part.t0, part.t0 + part.duration)]
    assert ends[0] < -0.1 and ends[5] > 0.1
    assert ends[1:5] == pytest.approx([0.0] * 4, abs=1e-6)
    # Neither the sole nor the heel lands with an impact: all speeds are continuous.
    for before, after in ((first, flat), (flat, toe)):
        np.testing.assert_allclose(before.at(before.t0 + before.duration).v, after.at(after.t0).v, atol=1e-8)


@pytest.mark.slow
def test_the_mirrored_walk_is_followed_on_the_soles_of_both_feet(walk: rt.Problem) -> None:
    """The plan holds the sole of one foot alone; the other one, which it holds by its toe, has the mirrored sole."""
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    solution = rt.plan(walk)
    course = ReferenceMotion(solution)
    assert {foot.name: foot.shape for foot in feet_of(course)} == dict.fromkeys(FEET, "BOX")
    for period, name in enumerate(FEET):
        (heel,) = landing_feet(course, 0, period)
        assert (heel.name, heel.pose.translation[0]) == (name, pytest.approx(-0.08))
    opinion = rt.witness.second_opinion(solution)
    assert opinion.completed and opinion.periods == 3 and opinion.saturated == 0.0
    for foot in opinion.feet:
        assert foot.planned is not None
        assert foot.force[2] == pytest.approx(foot.planned[2], rel=0.02)
