"""Steps from rest to rest: feet land on their footholds, and the robot ends at rest above the last ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

PAW = partial(rt.PointContact, friction=0.6)
SHORT: dict[str, Any] = {"contact": PAW, "swing": 0.15, "shift": 0.15, "clearance": 0.03}
BOLT: dict[str, Any] = SHORT | {"feet": ("FL_FOOT", "FR_FOOT"), "support": 0.05}


def planned(problem: rt.Problem) -> rt.Solution:
    return rt.plan(problem, rt.Mesh(5, rt.schemes.LobattoIIIA(4)))


def feet_at(solution: rt.Solution, t: float, feet: tuple[str, ...]) -> np.ndarray:
    """Positions (m, 3) of frames at a time."""
    robot = solution.phases[0].robot
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, solution.at(t).q)
    return np.array([data.oMf[robot.frame(foot)].translation for foot in feet])


def yaw(q: np.ndarray) -> float:
    x, y, z, w = q[3:7]
    return float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


def assert_it_rests(solution: rt.Solution) -> None:
    for t in (0.0, solution.duration):
        np.testing.assert_allclose(solution.at(t).v, 0, atol=1e-8)


def test_a_planar_biped_starts_and_stops(biped: rt.Robot) -> None:
    foot = partial(rt.PointContact, friction=0.8)
    problem = rt.gait.start_stop(
        biped, step_length=0.3, count=3, contact=foot, swing=0.4, shift=0.4, support=0.1, clearance=0.05
    )
    names = ["stand", "step 1", "support 1", "step 2", "support 2", "step 3", "stop"]
    assert [phase.name for phase in problem.phases] == names
    solution = planned(problem)
    assert_it_rests(solution)
    feet = ("left_foot", "right_foot")
    moved = feet_at(solution, solution.duration, feet) - feet_at(solution, 0.0, feet)
    np.testing.assert_allclose(moved, np.tile([0.6, 0, 0], (2, 1)), atol=1e-6)
    middle = solution.phases[1]
    swinging = ({*feet} - {contact.frame for contact in middle.phase.bound_contacts}).pop()
    heights = [feet_at(solution, t, (swinging,))[0, 2] for t in np.linspace(middle.t0, middle.t0 + middle.duration, 51)]
    assert max(heights) > 0.049


def test_solo12_starts_and_stops(solo: rt.Robot) -> None:
    solution = planned(rt.gait.start_stop(solo, step_length=0.05, count=3, support=0.0, **SHORT))
    assert_it_rests(solution)
    assert solution.at(solution.duration).q[0] - solution.at(0.0).q[0] == pytest.approx(0.1, abs=1e-6)


@pytest.mark.slow
def test_many_steps_take_no_more_iterations_than_few(solo: rt.Robot) -> None:
    feet = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")
    walks = [rt.gait.start_stop(solo, step_length=0.06, count=count, feet=feet) for count in (3, 12)]
    few, many = (rt.plan(walk, rt.Mesh(3), time_limit=60.0) for walk in walks)
    assert_it_rests(many)
    assert many.iterations <= 2 * few.iterations


def test_solo12_turns_on_the_spot(solo: rt.Robot) -> None:
    solution = planned(rt.gait.turn(solo, angle=0.3, support=0.0, **SHORT))
    assert_it_rests(solution)
    assert yaw(solution.at(solution.duration).q) == pytest.approx(0.3, abs=1e-6)
    feet = rt.gait.feet_of(solo, None)
    first, last = (feet_at(solution, t, feet)[:, :2] for t in (0.0, solution.duration))
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    np.testing.assert_allclose(last - last.mean(axis=0), (first - first.mean(axis=0)) @ turn.T, atol=1e-6)


def test_bolt_steps_to_either_side(bolt: rt.Robot) -> None:
    for distance, leading in ((0.03, "FL_FOOT"), (-0.03, "FR_FOOT")):
        problem = rt.gait.sidestep(bolt, distance=distance, **BOLT)
        assert leading not in [contact.label for contact in problem.phases[1].contacts]
        solution = planned(problem)
        assert_it_rests(solution)
        assert solution.at(solution.duration).q[1] - solution.at(0.0).q[1] == pytest.approx(distance, abs=1e-6)


def test_feet_stand_on_given_footholds(bolt: rt.Robot) -> None:
    feet = ("FL_FOOT", "FR_FOOT")
    home = planned_feet(bolt)
    places = [home[1] + [0.03, 0], home[0] + [0.05, 0.01], home[1] + [0.05, 0]]
    footholds = [{feet[(k + 1) % 2]: place} for k, place in enumerate(places)]
    solution = planned(rt.gait.steps(bolt, footholds, **BOLT))
    assert_it_rests(solution)
    first = solution.phases[2]
    np.testing.assert_allclose(feet_at(solution, first.t0 + 0.5 * first.duration, feet)[1, :2], places[0], atol=1e-4)
    np.testing.assert_allclose(feet_at(solution, solution.duration, feet)[:, :2], [places[1], places[2]], atol=1e-6)


def planned_feet(robot: rt.Robot) -> np.ndarray:
    """Horizontal positions (2, 2) of Bolt's feet in its standing posture."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, rt.gait.stand(robot, BOLT["feet"], PAW))
    return np.array([data.oMf[robot.frame(foot)].translation[:2] for foot in BOLT["feet"]])


WRONG: dict[str, tuple[Callable[[rt.Robot], rt.Problem], str]] = {
    "no steps": (lambda b: rt.gait.steps(b, [], **BOLT), "footholds= must be mappings"),
    "no foot": (
        lambda b: rt.gait.steps(b, [{"hand": (0, 0)}], **BOLT),
        "'hand', which is no foot; the feet",
    ),
    "no pair": (lambda b: rt.gait.steps(b, [{"FL_FOOT": (0.1,)}], **BOLT), r"step 1 is \(0.1,\); give \(x, y\)"),
    "all feet": (lambda b: rt.gait.steps(b, [{"FL_FOOT": (0, 0), "FR_FOOT": (0, 0)}], **BOLT), "moves all feet"),
    "no time": (
        lambda b: rt.gait.steps(b, [{"FL_FOOT": (0, 0)}], **(BOLT | {"swing": 0})),
        "swing.* is 0; give",
    ),
    "out of reach": (
        lambda b: rt.gait.steps(b, [{"FL_FOOT": (9, 0.1)}], **BOLT),
        "cannot stand on the footholds after step 1",
    ),
    "one step": (lambda b: rt.gait.start_stop(b, step_length=0.1, count=1, **BOLT), "at least 2 steps"),
    "three steps": (lambda b: rt.gait.sidestep(b, distance=0.1, count=3, **BOLT), "an even number of steps"),
    "half a turn": (lambda b: rt.gait.turn(b, angle=4.0, **BOLT), "less than half a turn"),
}


@pytest.mark.parametrize("case", WRONG)
def test_impossible_steps_are_refused(case: str, bolt: rt.Robot) -> None:
    make, message = WRONG[case]
    with pytest.raises(rt.InputError, match=message):
        make(bolt)


def test_a_planar_robot_has_no_side(biped: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="moves sideways, but 'five_link' has a planar root"):
        rt.gait.sidestep(biped, distance=0.1)


@pytest.mark.slow
def test_talos_lifts_its_feet_high_in_a_small_turn(tmp_path: Path) -> None:
    robot, soles = rt.load("talos_legs", root="floating"), ("left_sole_link", "right_sole_link")
    sole = partial(rt.FlatFoot, length=0.2, width=0.1, friction=0.7)
    # A foot that moves by 1 cm rises by 5 cm: an arc over so short a way would be too steep. On five intervals the foot
    # is up to 0.05 mm too low between the points; in the proved plan it is not.
    solution = rt.plan(rt.gait.turn(robot, angle=0.1, contact=sole, feet=soles, clearance=0.05))
    assert_it_rests(solution)
    assert yaw(solution.at(solution.duration).q) == pytest.approx(0.1, abs=1e-5)
    solution.save(tmp_path / "turn.npz")
    assert (
        rt.load_solution(tmp_path / "turn.npz").problem.phases[1].constraints == solution.problem.phases[1].constraints
    )
    ground = feet_at(solution, 0.0, soles)[:, 2]
    # The foot on the side of the turn, the left one, moves first.
    for k, phase in ((0, solution.phases[1]), (1, solution.phases[3])):
        heights = [feet_at(solution, phase.t0 + s * phase.duration, soles)[k, 2] for s in np.linspace(0, 1, 21)]
        assert max(heights) - ground[k] > 0.0499
