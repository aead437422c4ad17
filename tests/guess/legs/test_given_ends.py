"""The guess of a robot on its feet ends where bounds and rows of positions require it to."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from robotraj.guess.default import default_guess
from robotraj.problem.initial_guess import PhaseGuess

FEET = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")


@pytest.fixture(scope="module")
def robot() -> rt.Robot:
    return rt.load("solo12", root="floating")


def stance(robot: rt.Robot, **more: object) -> rt.Phase:
    feet = [rt.PointContact(foot) for foot in FEET]
    return rt.Phase(robot, 0.6, start=rt.State(q=gait.stand(robot, feet=FEET), v=0), contacts=feet, **more)


def guessed(phase: rt.Phase) -> PhaseGuess:
    problem = rt.Problem([phase])
    return default_guess(problem).prepared(problem).of(phase, 0)


def place(robot: rt.Robot, frame: str, q: np.ndarray) -> np.ndarray:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return np.array(data.oMf[robot.frame(frame)].translation)


def test_a_frame_reaches_its_place_while_the_feet_stand(robot: rt.Robot) -> None:
    home = gait.stand(robot, feet=FEET)
    aim = place(robot, "base_link", home) + [0.03, -0.02, -0.05]
    guess = guessed(stance(robot, constraints=[rt.AtEnd(rt.constraints.FramePosition("base_link", aim))]))
    first, middle, last = guess.states(np.array([0.0, 0.5, 1.0]))[:, : robot.nq]
    np.testing.assert_allclose(first, home, atol=1e-6)
    np.testing.assert_allclose(place(robot, "base_link", last), aim, atol=2e-3)
    for q in (middle, last):
        for foot in FEET:
            np.testing.assert_allclose(place(robot, foot, q), place(robot, foot, home), atol=1e-6)
    np.testing.assert_allclose(place(robot, "base_link", middle)[2], aim[2] + 0.025, atol=5e-3)


def test_a_row_on_one_side_that_holds_changes_nothing(robot: rt.Robot) -> None:
    above = rt.AtEnd(rt.PathConstraint(lambda point: point.frame("base_link").position[2], lower=0.1))
    s = np.linspace(0.0, 1.0, 5)
    plain, bounded = (guessed(stance(robot, constraints=rows)).states(s) for rows in ((), (above,)))
    np.testing.assert_allclose(bounded, plain, atol=1e-9)


def test_the_joints_of_a_given_end_are_reached(robot: rt.Robot) -> None:
    low = gait.stand(robot, feet=FEET, height=0.16)
    guess = guessed(stance(robot, end=rt.State(q=low, v=0)))
    last = guess.states(np.array([1.0]))[0, : robot.nq]
    np.testing.assert_allclose(last[7:], low[7:], atol=0.02)


@pytest.mark.parametrize("rises", [True, False])
def test_a_height_of_the_root_alone_is_reached_on_bent_knees(robot: rt.Robot, rises: bool) -> None:
    home = gait.stand(robot, feet=FEET)
    high, low = rt.State(q=home, v=0), rt.State(q={"root_z": home[2] - 0.06}, v=0)
    feet = [rt.PointContact(foot) for foot in FEET]
    start, end = (low, high) if rises else (high, low)
    phase = rt.Phase(robot, 0.7, start, end, gait.gait_objective(robot, home), contacts=feet)
    sunk, stood = guessed(phase).states(np.array([0.0, 1.0] if rises else [1.0, 0.0]))[:, : robot.nq]
    np.testing.assert_allclose(stood, home, atol=1e-5)
    assert abs(sunk[2] - home[2] + 0.06) < 0.01
    for foot in FEET:
        np.testing.assert_allclose(place(robot, foot, sunk)[2], 0.0, atol=1e-6)
    assert rt.plan(phase).iterations < 20


def test_a_second_phase_returns_to_its_given_end(robot: rt.Robot) -> None:
    home = gait.stand(robot, feet=FEET)
    aim = place(robot, "base_link", home) - [0.0, 0.0, 0.05]
    down = stance(robot, constraints=[rt.AtEnd(rt.constraints.FramePosition("base_link", aim))])
    feet = [rt.PointContact(foot) for foot in FEET]
    up = rt.Phase(robot, 0.6, end=rt.State(q=home, v=0), contacts=feet)
    problem = rt.Problem([down, up], [rt.Continuity(0, 1)])
    low, back = default_guess(problem).prepared(problem).of(up, 1).states(np.array([0.0, 1.0]))[:, : robot.nq]
    np.testing.assert_allclose(place(robot, "base_link", low), aim, atol=2e-3)
    np.testing.assert_allclose(back, home, atol=1e-5)


def test_a_reach_of_the_end_is_planned_in_few_iterations(robot: rt.Robot) -> None:
    home = gait.stand(robot, feet=FEET)
    aim = place(robot, "base_link", home) + [0.02, 0.0, -0.06]
    phase = stance(
        robot,
        end=rt.State(v=0),
        constraints=[rt.AtEnd(rt.constraints.FramePosition("base_link", aim))],
        objective=gait.gait_objective(robot, home),
    )
    assert rt.plan(phase, rt.Mesh(4)).iterations < 20


def test_a_foot_that_holds_a_rail_stays_there_and_does_not_count_as_standing(robot: rt.Robot) -> None:
    home = gait.stand(robot, feet=FEET)
    root = place(robot, "base_link", home)
    rail = place(robot, "FL_FOOT", home) + [0.02, 0.01, 0.05]
    grip = rt.contacts.LoopClosure("FL_FOOT", "universe", offset_b=tuple(rail))
    above = rt.AtEnd(rt.constraints.FramePosition("base_link", root + [0.0, 0.0, -0.02]))
    contacts = [grip, *(rt.PointContact(foot) for foot in FEET[1:])]
    guess = guessed(rt.Phase(robot, 0.6, end=rt.State(v=0), constraints=[above], contacts=contacts))
    for q in guess.states(np.array([0.0, 0.5, 1.0]))[:, : robot.nq]:
        np.testing.assert_allclose(place(robot, "FL_FOOT", q), rail, atol=1e-6)
        np.testing.assert_allclose([place(robot, foot, q)[2] for foot in FEET[1:]], 0.0, atol=1e-6)
    np.testing.assert_allclose(place(robot, "base_link", q)[2], root[2] - 0.02, atol=5e-3)
