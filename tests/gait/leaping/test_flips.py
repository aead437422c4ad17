"""Flips: one turn in the air between two stances, and requests that no legs can do."""

from __future__ import annotations

import time

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.gait.capability.turn_over import height_of_least_energy

STRONG = {"position": (-2.8, 2.8), "velocity": 30.0, "effort": 5.0}


def turned(plan: rt.Solution) -> np.ndarray:
    """Return the integral of the root's angular velocity in world axes (3,) [rad]."""
    t = np.linspace(0.0, plan.duration, 4001)
    samples = plan.at(t)
    if samples.q.shape[1] == samples.v.shape[1]:
        return np.array([0.0, np.trapezoid(samples.v[:, 2], t), 0.0])
    axis, w = samples.q[:, 3:6], samples.q[:, 6:7]
    across = 2.0 * np.cross(axis, samples.v[:, 3:6])
    return np.trapezoid(samples.v[:, 3:6] + w * across + np.cross(axis, across), t, axis=0)


def hopper() -> rt.Robot:
    return rt.load("hopper", root="planar")


@pytest.mark.slow
def test_a_hopper_turns_over_by_the_default_call() -> None:
    """To the front; ``docs/how-to/gaits.md`` turns it over backwards."""
    plan = rt.plan(rt.gait.flip(hopper(), axis=(0.0, 1.0, 0.0), feet=["foot"]))
    assert plan.proof.holds and rt.validate(plan).passed
    assert turned(plan)[1] == pytest.approx(2.0 * np.pi, rel=1e-3)


@pytest.mark.slow
def test_a_quadruped_turns_over_sideways_by_the_default_call() -> None:
    axis = (1.0, 0.0, 0.0)
    robot = rt.load("solo12", root="floating", limits=STRONG)
    plan = rt.plan(rt.gait.flip(robot, axis=axis))
    assert plan.proof.holds and rt.validate(plan).passed
    assert turned(plan) @ axis == pytest.approx(2.0 * np.pi, rel=0.01)


def test_the_last_feet_are_those_towards_which_the_robot_turns() -> None:
    robot = rt.load("solo12", root="floating", limits=STRONG)
    sides = {(0, -1, 0): ("HL", "HR"), (0, 1, 0): ("FL", "FR"), (1, 0, 0): ("FR", "HR"), (-1, 0, 0): ("FL", "HL")}
    every = {"FL", "FR", "HL", "HR"}
    for axis, last in sides.items():
        phases = rt.gait.flip(robot, axis=axis).phases
        held = [{contact.label.split("_")[0] for contact in phase.contacts} for phase in phases]
        assert held == [every, set(last), set(), every - set(last), every]


def test_a_body_of_known_gyration_turns_with_least_energy_at_its_height() -> None:
    """h + c^2 / h is least at h = c, with c = pi k / 2 and the radius of gyration k of the whole robot."""
    robot = hopper()
    standing = np.array(rt.gait.stand(robot, ["foot"]))
    rates, data = np.zeros(robot.nv), robot.model.createData()
    rates[2] = 1.0
    pin.centerOfMass(robot.model, data, standing, rates)
    energy = pin.computeKineticEnergy(robot.model, data, standing, rates)
    turning = energy - 0.5 * robot.mass * float(np.sum(np.array(data.vcom[0]) ** 2))
    gyration = np.sqrt(2.0 * turning / robot.mass)
    assert height_of_least_energy(robot, standing, (0.0, 1.0, 0.0)) == pytest.approx(0.5 * np.pi * gyration)


@pytest.mark.parametrize("height", [0.01, 4.0])
def test_flips_beyond_the_legs_are_refused_within_two_seconds(height: float) -> None:
    robot = rt.load("go1", root="floating")
    began = time.process_time()
    with pytest.raises(rt.InputError, match=rf"height\) is {height:g} m: one turn.*height=0\.\d+ needs .* would do"):
        rt.gait.flip(robot, height=height)
    assert time.process_time() - began < 2.0


def test_a_robot_too_weak_for_any_flip_is_told_so() -> None:
    weak = rt.load("solo12", root="floating", limits=STRONG | {"effort": 0.8})
    with pytest.raises(rt.InputError, match=r"Any flip needs that of 0\.\d+ m; give motors with higher limits"):
        rt.gait.flip(weak)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0), (0.0, np.nan, 0.0)])
def test_an_axis_that_is_not_horizontal_is_refused(axis: tuple[float, ...]) -> None:
    with pytest.raises(rt.InputError, match="give a horizontal axis"):
        rt.gait.flip(hopper(), axis=axis, feet=["foot"])


def test_a_planar_root_turns_about_y_only() -> None:
    with pytest.raises(rt.InputError, match="root='planar'.*turns about y"):
        rt.gait.flip(hopper(), axis=(1.0, 0.0, 0.0), feet=["foot"])
