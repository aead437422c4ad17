"""Invalid arguments of gaits, and grounds that do not repeat."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.contacts.base import of_impulses
from robotraj.gait.repetition import DurationRatio

FOOT = rt.PointContact("left_foot", friction=0.8)
PAW = partial(rt.PointContact, friction=0.6)


WRONG: dict[str, tuple[Callable[[rt.Robot], Any], str]] = {
    "free length": (lambda b: step(b, step_length=rt.between(0.2, 0.5)), "step_length.*rt.Periodic"),
    "length of text": (lambda b: step(b, step_length="far"), "step_length"),
    "duration of text": (lambda b: step(b, duration="fast"), "duration.*'fast'"),
    "clearance of text": (lambda b: step(b, clearance="high"), "clearance.*'high'"),
    "double support of text": (lambda b: step(b, double_support="a"), "double_support"),
    "whole double support": (lambda b: step(b, double_support=1.0), "double_support.*less than 1"),
    "a contact with further arguments": (lambda b: step(b, contact=rt.FlatFoot), "'length'.*functools.partial"),
    "repeat by name": (lambda b: step(b, repeat="mirror"), "repeat=.*rt.Periodic"),
    "upright by name": (lambda b: step(b, upright=True), "upright="),
    "flight of text": (lambda b: rt.gait.run(b, step_length=0.5, duration=0.5, contact=FOOT, flight="x"), "flight"),
    "no flight": (lambda b: rt.gait.run(b, step_length=0.5, duration=0.5, contact=FOOT, flight=0), "rt.gait.walk"),
    "length of a jump": (lambda b: rt.gait.jump(b, length="far"), "length.*'far'"),
    "height of a jump": (lambda b: rt.gait.jump(b, height="0.2"), "height.*'0.2'"),
    "supports": (lambda b: rt.gait.sequence(b, [("left_foot", 0.3)], rt.gait.GaitTerms(FOOT), None), "rt.gait.Support"),
    "no supports": (lambda b: rt.gait.sequence(b, [], rt.gait.GaitTerms(FOOT), None), "rt.gait.Support"),
    "too tall": (lambda b: rt.gait.stand(b, height=1.2), "1.2 m above.* the nearest height found is"),
}


def step(biped: rt.Robot, **changes: Any) -> rt.Problem:
    return rt.gait.walk(biped, **{"step_length": 0.4, "duration": 0.6, "contact": FOOT, **changes})


@pytest.mark.parametrize("case", WRONG)
def test_invalid_arguments_are_named(case: str, biped: rt.Robot) -> None:
    make, message = WRONG[case]
    with pytest.raises(rt.InputError, match=message):
        make(biped)


def test_a_negative_flight_is_refused(solo: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="trot.flight. is -0.5"):
        rt.gait.trot(solo, step_length=0.06, duration=0.2, flight=-0.5, contact=PAW)


def test_speeds_after_an_impact_have_no_displacement(biped: rt.Robot) -> None:
    faster = replace(rt.gait.mirror(biped), displacement={"v.root_x": 1.0})
    with pytest.raises(rt.InputError, match=r"'v.root_x' follows from the impact; remove its displacement"):
        step(biped, repeat=faster)


def test_numpy_numbers_are_accepted(biped: rt.Robot) -> None:
    for number in (np.float32, np.float64, np.array):
        (phase,) = step(biped, step_length=number(0.4), duration=number(0.6), clearance=number(0.0)).phases
        assert phase.duration == pytest.approx(0.6)


def test_a_free_duration_may_be_between(biped: rt.Robot) -> None:
    assert step(biped, duration=rt.between(0.4, 0.9)).phases[0].duration == (0.4, 0.9)


@pytest.mark.parametrize("duration", [(0.4, np.inf), (0.4, None), rt.between(0.4, None)], ids=str)
def test_a_free_duration_may_be_open(duration: Any, biped: rt.Robot) -> None:
    assert step(biped, duration=duration).phases[0].duration_bounds == (0.4, np.inf)
    gait = step(biped, duration=duration, double_support=0.2)
    assert [phase.duration_bounds[0] for phase in gait.phases] == pytest.approx([0.08, 0.32])
    solution = rt.plan(gait, rt.Mesh(6))
    assert solution.phases[0].duration / solution.duration == pytest.approx(0.2, abs=1e-6)


def test_shares_are_kept_where_nothing_bounds_the_duration(biped: rt.Robot) -> None:
    gait = rt.gait.run(biped, step_length=0.9, duration=rt.between(None, None), flight=0.4, contact=FOOT)
    (tie,) = (link for link in gait.links if isinstance(link, rt.links.Linkage))
    assert tie.expression == DurationRatio(pytest.approx(2 / 3))


@pytest.mark.parametrize("height", [0.75, 0.8, 0.85])
def test_given_standing_heights_are_reached(biped: rt.Robot, height: float) -> None:
    q = rt.gait.stand(biped, height=height)
    assert pin.centerOfMass(biped.model, biped.model.createData(), q)[2] == pytest.approx(height, abs=1e-2)


def test_grounds_that_do_not_repeat_are_refused(biped: rt.Robot, solo: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="The gait repeats, but the ground does not: after .* under 'left_foot'"):
        step(biped, step_length=0.5, ground=rt.terrain.Steps([0.3], [0, 0.1]))
    trot = partial(rt.gait.trot, solo, step_length=0.06, duration=0.2, contact=PAW)
    with pytest.raises(rt.InputError, match="but the ground does not"):
        trot(ground=rt.terrain.Slope(0.0, 0.15))


def test_contacts_lie_on_grounds_that_repeat(biped: rt.Robot, solo: rt.Robot) -> None:
    slope, stairs = rt.terrain.Slope(0.1), rt.terrain.Steps.stairs(start=0.2, run=0.4, rise=0.1, count=4)
    trot = partial(rt.gait.trot, solo, step_length=0.06, duration=0.2, contact=PAW)
    across = rt.terrain.Slope(0.0, 0.15)
    written = {
        slope: step(biped, ground=slope),
        stairs: step(biped, step_length=0.4, ground=stairs),
        rt.terrain.Slope(0.15, 0.0): trot(ground=rt.terrain.Slope(0.15, 0.0)),
        # Both halves of the stride are planned: nothing is mirrored.
        across: trot(ground=across, repeat=rt.Periodic()),
    }
    for ground, problem in written.items():
        contacts = [contact for phase in problem.phases for contact in phase.contacts]
        assert contacts and all(contact.ground == ground for contact in contacts)


def test_clearance_holds_at_the_offset_of_a_contact(biped: rt.Robot) -> None:
    shins = "left_tibia", "right_tibia"
    below = rt.PointContact("left_tibia", friction=0.8, offset=(0, 0, -0.4))
    solution = rt.plan(step(biped, feet=shins, contact=below, clearance=0.15), rt.Mesh(12))
    data, highest = biped.model.createData(), 0.0
    for q in solution.at(np.linspace(0, solution.duration, 101)).q:
        pin.framesForwardKinematics(biped.model, data, q)
        highest = max(highest, data.oMf[biped.frame("right_tibia")].act(np.array([0.0, 0.0, -0.4]))[2])
    assert highest > 0.145


def test_a_turn_does_not_change_the_quaternions_sign(solo: rt.Robot) -> None:
    turn = {"q.root_qz": 0.1, "q.root_qw": None, "q.root_x": None, "q.root_y": None}
    gait = rt.gait.trot(solo, step_length=0.0, duration=0.2, contact=PAW, repeat=rt.Periodic(displacement=turn))
    solution = rt.plan(gait, rt.Mesh(5, rt.schemes.LobattoIIIA(4)))
    assert np.all(solution.at(np.linspace(0, solution.duration, 101)).q[:, 6] > 0.99)


def test_bounds_of_normal_forces_do_not_bound_impulses() -> None:
    for bounds in ((0.0, 2000.0), (1.0, np.inf), (0.0, np.inf)):
        contact = rt.PointContact("left_foot", friction=0.8, normal_force=bounds)
        bound = contact.bound_to(rt.load("five_link", root="floating"))
        kept = [of_impulses(row) for row in bound.limit_rows]
        assert all(row is not None and (row.lower, row.upper) == (0.0, np.inf) for row in kept)


def highest(biped: rt.Robot, solution: rt.Solution, foot: str) -> float:
    data, top = biped.model.createData(), 0.0
    for q in solution.at(np.linspace(0, solution.duration, 101)).q:
        pin.framesForwardKinematics(biped.model, data, q)
        top = max(top, data.oMf[biped.frame(foot)].translation[2])
    return top


def test_both_steps_of_a_stride_clear_the_ground(biped: rt.Robot) -> None:
    solution = rt.plan(step(biped, clearance=0.1, repeat=rt.Periodic()), rt.Mesh(8))
    assert min(highest(biped, solution, foot) for foot in ("left_foot", "right_foot")) > 0.095


def test_a_clearance_without_effect_warns(biped: rt.Robot) -> None:
    free = replace(rt.gait.mirror(biped), displacement={"q.root_x": rt.between(0.3, 0.5)})
    with pytest.warns(UserWarning, match="clearance=0.1 is not imposed on right_foot in 'single support'"):
        step(biped, clearance=0.1, repeat=free)
    with pytest.warns(UserWarning, match="clearance=0.1 is not imposed"):
        step(biped, clearance=0.1, step_length=0.0)


def test_shares_of_a_step_are_kept_where_its_duration_is_free(biped: rt.Robot) -> None:
    objective = rt.Effort() + 50 * rt.Duration()
    walk = step(biped, duration=(0.4, 0.9), double_support=0.2, objective=objective)
    run = rt.gait.run(biped, step_length=0.9, duration=(0.3, 0.6), flight=0.4, contact=FOOT)
    for gait, share in ((walk, 0.2), (run, 0.6)):
        solution = rt.plan(gait, rt.Mesh(10))
        assert solution.phases[0].duration / solution.duration == pytest.approx(share, abs=1e-6)
        low, high = (sum(bound) for bound in zip(*(phase.duration for phase in gait.phases), strict=True))
        assert low - 1e-6 < solution.duration < high + 1e-6


def test_all_of_a_sole_stays_above_the_ground() -> None:
    robot = rt.load("talos_legs", root="floating")
    sole = partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.8)
    feet = "left_sole_link", "right_sole_link"
    gait = rt.gait.walk(robot, step_length=0.45, duration=0.8, double_support=0.2, feet=feet, contact=sole)
    solution = rt.plan(gait, rt.Mesh(6, rt.schemes.LobattoIIIA(4)))
    data, lowest = robot.model.createData(), np.inf
    for q in solution.at(np.linspace(0, solution.duration, 201)).q:
        pin.framesForwardKinematics(robot.model, data, q)
        corners = [np.array([x, y, 0.0]) for x in (-0.1, 0.1) for y in (-0.06, 0.06)]
        lowest = min(lowest, *(data.oMf[robot.frame(foot)].act(corner)[2] for foot in feet for corner in corners))
    assert lowest > -1e-3
