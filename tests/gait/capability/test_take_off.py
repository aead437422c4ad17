"""Jumps that are far too high are refused before a solve, with a height that would do."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest

import robotraj as rt
from robotraj.gait.capability.leg_samples import sample_legs
from robotraj.gait.capability.take_off import greatest_rise


def hopper(effort: float, velocity: float) -> rt.Robot:
    limits = {"effort": {"hip": 0.1 * effort, "leg": effort}, "velocity": {"hip": 15.0, "leg": velocity}}
    return rt.load("hopper", root="planar", limits=limits)


def rise(robot: rt.Robot, margin: float = 0.0) -> float:
    return greatest_rise(robot, ["foot"], rt.gait.stand(robot, ["foot"]), 0.7, margin)


def test_a_leg_that_cannot_carry_the_robot_lifts_it_by_nothing() -> None:
    assert rise(hopper(20.0, 5.0)) < 1e-2
    assert rise(hopper(150.0, 5.0)) > 0.5


def test_slow_legs_take_off_slowly() -> None:
    """The root rises at the speed of the sliding leg, to which the hip adds the rest where the leg is tilted."""
    slow, fast = rise(hopper(400.0, 0.5)), rise(hopper(400.0, 5.0))
    assert 0.5**2 / (2.0 * 9.81) < slow < 0.2 * fast


def test_a_straight_leg_gives_no_more_energy_than_its_speed() -> None:
    """Strong motors accelerate the root to the speed at which the legs stretch, whatever a straight leg carries."""
    robot = rt.load("five_link", root="planar", limits={"effort": 1e5, "velocity": 2.0})
    posture, feet = rt.gait.stand(robot), ["left_foot", "right_foot"]
    samples = sample_legs(robot, feet, posture, 0.7, 0.0)
    assert samples is not None
    fastest = float(samples.speeds((0.0, 0.0, 1.0)).max(axis=1).min())
    assert 0.0 < greatest_rise(robot, feet, posture, 0.7, 0.0) <= fastest**2 / (2.0 * 9.81)


def test_the_rise_grows_with_torque_and_falls_with_the_margin() -> None:
    rises = [rise(hopper(effort, 5.0)) for effort in (60.0, 100.0, 150.0)]
    assert rises == sorted(rises) and rises[0] < rises[-1]
    assert rise(hopper(150.0, 5.0), margin=0.4) < rises[-1]


def test_a_jump_of_three_metres_is_refused_within_two_seconds() -> None:
    robot = rt.load("go2", root="floating")
    began = time.process_time()
    with pytest.raises(
        rt.InputError, match=r"3 m, a take-off at 7.67 m/s.*effort and velocity limits.*height=0\.\d+ would do"
    ):
        rt.gait.jump(robot, height=3.0)
    assert time.process_time() - began < 2.0


def test_a_jump_out_of_proportion_is_doubted_even_of_motors_without_limits() -> None:
    strong = rt.load("hopper", root="planar", limits={"effort": np.inf, "velocity": np.inf})
    with pytest.warns(UserWarning, match="goes over 30 m, .* Lengths are in metres: 20 cm are 0.2"):
        rt.gait.jump(strong, height=30.0, feet=["foot"])


def test_motors_without_limits_are_not_judged() -> None:
    robot = rt.load("hopper", root="planar", limits={"effort": np.inf})
    assert rise(robot) == np.inf


def test_a_jump_of_four_metres_is_refused_with_one_that_would_do() -> None:
    robot = rt.load("go2", root="floating")
    with pytest.raises(rt.InputError, match=r"length\) is -4 m.*length=-0\.\d+ with height=0\.\d+ would do"):
        rt.gait.jump(robot, length=-4.0)


@pytest.mark.slow
def test_the_stated_jump_is_planned() -> None:
    robot = rt.load("go2", root="floating")
    with pytest.raises(rt.InputError) as refusal:
        rt.gait.jump(robot, length=4.0)
    length, height = re.search(r"length=(\S+) with height=(\S+) would", str(refusal.value)).groups()  # type: ignore[union-attr]
    assert rt.plan(rt.gait.jump(robot, length=float(length), height=float(height))).success
