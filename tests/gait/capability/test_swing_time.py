"""Swings and pushes that are too short for the motors are refused before a solve, with one that would do."""

from __future__ import annotations

import re
import time
from collections.abc import Callable

import numpy as np
import pytest

import robotraj as rt
from robotraj.gait.capability.leg_samples import sample_legs
from robotraj.gait.capability.swing_time import BEYOND, check_swing_time
from robotraj.robot.coupling.dynamics import mass_matrix

STEPS: dict[str, tuple[str, Callable[[rt.Robot], rt.Problem]]] = {
    "sidestep": ("a1", lambda robot: rt.gait.sidestep(robot, distance=0.15, swing=0.025)),
    "turn": ("anymal_c", lambda robot: rt.gait.turn(robot, angle=-0.8, count=2, swing=0.05)),
    "start_stop": ("go1", lambda robot: rt.gait.start_stop(robot, step_length=0.3, swing=0.03)),
    "crawl": ("solo12", lambda robot: rt.gait.crawl(robot, step_length=0.12, duration=0.07)),
    "jump": ("bolt", lambda robot: rt.gait.jump(robot, height=0.1, push=0.01)),
}
LIMITS = {"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7}


def loaded(name: str) -> rt.Robot:
    return rt.load(name, root="floating", limits=LIMITS if name in ("solo12", "bolt") else None)


def test_a_vertical_leg_of_one_joint_accelerates_its_foot_by_its_torque_and_inertia() -> None:
    """a = l tau / I for a foot at the distance l below a joint with the inertia I."""
    robot = rt.load("compass_walker", root="planar", actuated=["left_hip"], limits={"effort": {"left_hip": 3.0}})
    samples = sample_legs(robot, ["left_foot"], robot.neutral, 0.0, 0.0, 0)
    assert samples is not None
    (j,) = (i for i, name in enumerate(robot.velocity_names) if name == "left_hip")
    inertia = mass_matrix(robot.model, robot.model.createData(), robot.neutral)[j, j]
    exact = samples.lengths[0, 0] * 3.0 / inertia
    assert samples.accelerations((1.0, 0.0, 0.0))[0] == pytest.approx(exact, rel=1e-9)
    # From rest to rest over d, half of the time with a and half of it with -a takes 2 sqrt(d / a).
    way = 0.01
    least = 2.0 * np.sqrt(way / (BEYOND * exact))
    slow = {"left_hip": np.inf}
    free = rt.load(
        "compass_walker", root="planar", actuated=["left_hip"], limits={"effort": {"left_hip": 3.0}, "velocity": slow}
    )
    check_swing_time(free, free.neutral, {"left_foot": way}, 1.001 * least, 0.0, str)
    with pytest.raises(rt.InputError, match="swings over 0.01 m"):
        check_swing_time(free, free.neutral, {"left_foot": way}, 0.999 * least, 0.0, str)
    # A foot that lands with an impact covers twice the way.
    check_swing_time(free, free.neutral, {"left_foot": 2.0 * way}, 1.001 * least, 0.0, str, impact=True)


def test_a_speed_limit_lengthens_the_swing_over_a_long_way() -> None:
    """Where the foot reaches V, a swing takes d / V + V / a, so that it grows with d alone for large d."""
    robot = rt.load(
        "compass_walker", root="planar", actuated=["left_hip"], limits={"velocity": 0.5, "effort": {"left_hip": 1e6}}
    )
    samples = sample_legs(robot, ["left_foot"], robot.neutral, 0.0, 0.0, 0)
    assert samples is not None
    speed = 2.0 * samples.speeds((1.0, 0.0, 0.0))[0, 0]
    check_swing_time(robot, robot.neutral, {"left_foot": 1.0}, 1.01 / speed, 0.0, str)
    with pytest.raises(rt.InputError, match="swings over 1 m"):
        check_swing_time(robot, robot.neutral, {"left_foot": 1.0}, 0.99 / speed, 0.0, str)


@pytest.mark.filterwarnings("ignore:The inertia of")
@pytest.mark.parametrize("name", STEPS)
def test_a_swing_that_is_too_short_is_refused_within_two_seconds(name: str) -> None:
    robot, make = loaded(STEPS[name][0]), STEPS[name][1]
    began = time.process_time()
    with pytest.raises(rt.InputError, match=r"(swings over|The push of).* would do"):
        make(robot)
    assert time.process_time() - began < 2.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a1", "go1"])
def test_the_swing_that_would_do_is_planned(name: str) -> None:
    robot = loaded(name)
    with pytest.raises(rt.InputError) as refusal:
        rt.gait.sidestep(robot, distance=0.1, swing=0.02)
    swing = float(re.search(r"swing=([\d.]+) would do", str(refusal.value))[1])  # type: ignore[index]
    solution = rt.plan(rt.gait.sidestep(robot, distance=0.1, swing=swing), progress=False)
    assert solution.proof is not None and solution.proof.holds


def test_a_run_that_is_named_is_proved() -> None:
    """A longer time alone left a step of 1 m, in which the shin passes through the torso."""
    robot = rt.load("five_link", root="planar")
    with pytest.raises(rt.InputError, match="would do") as refusal:
        rt.gait.run(robot, step_length=1.0, duration=0.1)
    length, duration = (float(x) for x in re.findall(r"step_length=(\S+) with duration=(\S+) ", str(refusal.value))[0])
    solution = rt.plan(rt.gait.run(robot, step_length=length, duration=duration), check=False)
    assert solution.success and solution.proof is not None and solution.proof.holds
