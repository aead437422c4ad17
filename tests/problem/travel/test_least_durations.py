"""Least times of one joint against closed forms, and the durations that a phase refuses by them."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.travel.least_durations import _Travel


def travel(first: float, last: float, v0: float = 0.0, v1: float = 0.0, speed: float = np.inf) -> _Travel:
    return _Travel("joint", "rad", first, last, v0, v1, speed, 2.0)


def test_from_rest_to_rest_over_d_takes_two_roots_of_d_by_a() -> None:
    assert travel(0.0, 3.0).least_time(2.0) == pytest.approx(2.0 * np.sqrt(1.5))
    assert travel(1.0, -2.0).least_time(2.0) == pytest.approx(2.0 * np.sqrt(1.5))


def test_with_a_speed_limit_v_it_takes_d_by_v_and_v_by_a() -> None:
    assert travel(0.0, 3.0, speed=1.0).least_time(2.0) == pytest.approx(3.0 + 0.5)


@pytest.mark.parametrize("ends", [(0.0, 1.0, 0.5, -0.3), (0.0, 0.01, 2.0, 0.0), (0.4, -0.2, 1.0, 1.0), (0, 0, 1, -1)])
def test_the_least_time_is_that_of_the_collocated_problem(ends: tuple[float, float, float, float]) -> None:
    first, last, v0, v1 = ends
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    bounds = {"u": rt.between(-2, 2)}
    phase = rt.Phase(block, (0.01, 9.0), rt.State([first, v0]), rt.State([last, v1]), rt.Duration(), controls=bounds)
    assert travel(*ends).least_time(2.0) == pytest.approx(rt.plan(phase, tolerance=1e-6).duration, rel=1e-4)


def arm(duration: float, end: float, speed: float = 0.0, **limits: object) -> rt.Phase:
    robot = rt.load("two_link_arm")
    start = rt.State(q=0, v=[speed, 0])
    return rt.Phase(robot, duration, start, rt.State(q=[end, 0], v=0), limits=robot.limits.with_(**limits))


def test_a_phase_names_the_acceleration_and_the_duration_that_would_do() -> None:
    with pytest.raises(rt.InputError, match="'shoulder' must travel 1 rad in 1 s.* at least 1.414 s, or .* 4 rad/s"):
        arm(1.0, 1.0, acceleration=2.0, velocity=100.0)
    assert arm(1.0, 1.0, acceleration=4.0, velocity=100.0)


def test_a_speed_that_no_joint_can_lose_is_refused() -> None:
    limits = {"position": 0.1, "acceleration": 5.0}
    with pytest.raises(rt.InputError, match="'shoulder' is 0.1 rad from its position limit of 0.1 rad .* 20 rad/s"):
        arm(5.0, 0.05, speed=2.0, **limits)
    assert arm(5.0, 0.05, speed=0.9, **limits)


def test_a_fixed_duration_that_seems_to_be_in_milliseconds_is_doubted() -> None:
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1, 0], v=0)
    slow = rt.load("cartpole").limits.with_(velocity=2.0)
    with pytest.warns(UserWarning, match="The unit is s: 2000 ms are 2 s"):
        rt.Phase(rt.load("cartpole"), 2000.0, *ends, limits=slow)
    with pytest.warns(UserWarning, match="The unit is s: 100 ms are 0.1 s"):
        rt.Phase(rt.load("cartpole"), (100.0, 10000.0), *ends, limits=slow)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for duration in (2.0, (0.1, 2000.0)):  # an upper bound is no duration
            rt.Phase(rt.load("cartpole"), duration, *ends, limits=slow)


def test_a_rest_that_seems_to_be_in_milliseconds_is_doubted() -> None:
    """Without a travel, the measure is the time sqrt(l / g) of the robot's reach l."""
    arm = rt.load("two_link_arm")
    here = rt.State(q=0.3, v=0)
    with pytest.warns(UserWarning, match="at least 2000 s. The unit is s: 2000 ms are 2 s"):
        rt.Phase(arm, 2000.0, here, here)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for duration in (20.0, (0.1, 2000.0)):
            rt.Phase(arm, duration, here, here)


def test_limits_of_constraints_count_as_those_of_the_robot_do() -> None:
    robot = rt.load("two_link_arm")
    ends = rt.State(q=0, v=0), rt.State(q=[1, 0], v=0)
    with pytest.raises(rt.InputError, match="'shoulder' must travel 1 rad, but its velocity limit of 0.5 rad/s"):
        rt.Phase(robot, 1.0, *ends, constraints=[rt.constraints.JointVelocity(0.5)])
    with pytest.raises(rt.InputError, match="with its acceleration limit of 2 rad/s.2 it takes 1.414 s"):
        rt.Phase(robot, 1.0, *ends, constraints=[rt.constraints.JointAcceleration(2.0)])
    with pytest.raises(rt.InputError, match="limit of 0 rad/s.2 it keeps its speed. Allow an acceleration of at "):
        rt.Phase(robot, 1.0, *ends, constraints=[rt.constraints.JointAcceleration(0.0)])
