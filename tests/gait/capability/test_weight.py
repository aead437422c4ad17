"""Loads that the legs cannot carry are refused before a solve, with a mass that would do."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest

import robotraj as rt
from robotraj.gait.capability.leg_samples import sample_legs
from robotraj.gait.capability.weight import bent_forces, check_rest


def loaded(mass: float) -> rt.Robot:
    body = rt.robot.CarriedBody("base", mass, inertia=0.01 * mass * np.eye(3))
    return rt.robot.carrying(rt.load("go2", root="floating"), body)


def trot(robot: rt.Robot) -> rt.Problem:
    return rt.gait.trot(robot, step_length=0.1, duration=0.3)


def test_a_vertical_leg_carries_the_force_of_its_motor() -> None:
    """The sliding leg of the hopper pushes with its effort limit, so that weights around it decide."""
    for share, refused in ((0.5, True), (1.0, False)):
        hopper = rt.load("hopper", root="planar")
        effort = share * hopper.mass * 9.81
        robot = rt.load("hopper", root="planar", limits={"effort": {"leg": effort, "hip": 100.0}})
        if refused:
            with pytest.raises(rt.InputError, match=rf"weighs {robot.mass * 9.81:.3g} N.*{effort:.2g} N at most"):
                check_rest(robot, ["foot"], robot.neutral, 0.0, 0.0)
        else:
            check_rest(robot, ["foot"], robot.neutral, 0.0, 0.0)


@pytest.mark.filterwarnings("ignore:The inertia of 'go2'")
def test_a_heavy_load_is_refused_within_two_seconds_and_the_stated_mass_trots() -> None:
    began = time.process_time()
    with pytest.raises(rt.InputError, match=r"316 kg with what it carries.* kg would do") as refusal:
        trot(loaded(300.0))
    assert time.process_time() - began < 2.0
    mass = float(re.search(r"([\d.]+) kg would do", str(refusal.value))[1])  # type: ignore[index]
    load = mass - rt.load("go2", root="floating").mass
    assert load > 5.0
    assert rt.plan(trot(loaded(load)), mesh=rt.Mesh(12)).success


def test_a_load_that_cannot_be_held_at_rest_is_refused_by_a_jump() -> None:
    with pytest.raises(rt.InputError, match="in the configuration in which it stands"):
        rt.gait.jump(loaded(500.0))


def test_a_leg_that_is_bent_carries_what_its_knee_does() -> None:
    """Between hip and knee of equal links l, at most 0.95 straight, lies b = l sin(acos(0.95)).

    A force through the foot passes one of them at b / 2 or more, so that it is at most 2 tau / b, also for a straight
    leg that stands obliquely.
    """
    robot = rt.load("five_link", root="planar")
    samples = sample_legs(robot, ["left_foot"], rt.gait.stand(robot), 1.0, 0.0)
    assert samples is not None
    link = 0.5 * float(samples.lengths.max())
    assert bent_forces(samples)[0] < 2.0 * 100.0 / (link * np.sin(np.arccos(0.95)))


@pytest.mark.filterwarnings("ignore:The inertia of")
def test_a_crawl_on_weak_motors_is_refused_within_two_seconds() -> None:
    robot = rt.load("hyq", root="floating", limits={"effort": 15.0})
    began = time.process_time()
    with pytest.raises(rt.InputError, match=r"carries about \S+ N at most in this gait"):
        rt.gait.crawl(robot, step_length=0.1, duration=2.0)
    assert time.process_time() - began < 2.0


def test_joints_without_a_motor_are_not_judged() -> None:
    """A leg whose knee has a spring in place of a motor carries what its other joints carry."""
    joints = [name for name in rt.load("five_link").velocity_names if "knee" not in name]
    sprung = rt.load("five_link", root="planar", actuated=joints)
    whole = rt.load("five_link", root="planar")
    forces = []
    for robot in (whole, sprung):
        samples = sample_legs(robot, ["left_foot", "right_foot"], rt.gait.stand(whole), 0.5, 0.0, 50)
        assert samples is not None
        forces.append(samples.forces)
    assert (forces[1] >= forces[0]).all() and (forces[1] > forces[0]).any()
