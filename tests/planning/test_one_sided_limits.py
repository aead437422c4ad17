"""Limits with two sides: closed forms of a winch that only pulls, and one size of a row for proof and witness."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

GRAVITY = 9.81


def winch(effort, speed=(-9.0, 9.0)):
    """A load of 1 kg on a vertical slide, from a pin.Model with two-sided limits."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelPZ(), pin.SE3.Identity(), "winch")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), 0.01 * np.eye(3)), pin.SE3.Identity())
    model.lowerEffortLimit, model.upperEffortLimit = np.array([effort[0]]), np.array([effort[1]])
    model.lowerVelocityLimit, model.upperVelocityLimit = np.array([speed[0]]), np.array([speed[1]])
    model.lowerPositionLimit, model.upperPositionLimit = np.array([-5.0]), np.array([5.0])
    return model


def least_time(robot, way=2.0):
    ends = rt.State(q=[0.0], v=0), rt.State(q=[way], v=0)
    return rt.plan(rt.Phase(robot, (0.05, 9.0), *ends, rt.Duration()), progress=False)


def trapezoid(way, rise, fall, speed):
    """Least time over a way with accelerations ``rise`` and ``-fall`` and a speed limit."""
    peak = np.sqrt(2.0 * way / (1.0 / rise + 1.0 / fall))
    if peak <= speed:
        return peak / rise + peak / fall
    ramps = 0.5 * speed**2 * (1.0 / rise + 1.0 / fall)
    return speed / rise + speed / fall + (way - ramps) / speed


@pytest.mark.parametrize("effort", [(0.0, 30.0), (-5.0, 30.0), (2.0, 30.0)])
@pytest.mark.parametrize("way", [2.0, -2.0])
def test_a_motor_that_only_pulls_lifts_and_lowers_in_the_closed_form_time(effort, way):
    up, down = effort[1] - GRAVITY, GRAVITY - effort[0]
    solution = least_time(rt.load(winch(effort)), way)
    right = trapezoid(2.0, up, down, 9.0) if way > 0 else trapezoid(2.0, down, up, 9.0)
    assert solution.duration == pytest.approx(right, rel=1e-3)
    tau = solution.at(np.linspace(0.0, solution.duration, 999)).tau
    assert effort[0] - 1e-3 * 15 < tau.min() <= tau.max() < effort[1] + 1e-3 * 15
    assert solution.proof.holds
    assert rt.validate(solution).passed


@pytest.mark.parametrize(("way", "speed"), [(2.0, 3.0), (-2.0, 1.0)])
def test_each_direction_has_its_own_speed(way, speed):
    effort = (0.0, 30.0)
    rise, fall = (30.0 - GRAVITY, GRAVITY) if way > 0 else (GRAVITY, 30.0 - GRAVITY)
    solution = least_time(rt.load(winch(effort, (-1.0, 3.0))), way)
    assert solution.duration == pytest.approx(trapezoid(2.0, rise, fall, speed), rel=1e-3)
    assert rt.validate(solution).passed


def test_limits_by_name_are_those_of_the_model():
    given = rt.load(winch((-30.0, 30.0)), limits={"effort": {"winch": (0.0, 30.0)}, "velocity": rt.between(-1.0, 3.0)})
    model = rt.load(winch((0.0, 30.0), (-1.0, 3.0)))
    for quantity in ("velocity", "effort"):
        np.testing.assert_array_equal(given.limits.sides(quantity), model.limits.sides(quantity))
    assert "[0, 30]" in str(given)
    assert "[-1, 3]" in str(given)


def test_an_end_that_a_one_sided_motor_cannot_hold_is_named():
    robot = rt.load(winch((12.0, 30.0)))  # it always pulls more than the weight
    phase = rt.Phase(robot, 1.0, rt.State(q=[0.0], v=0), rt.State(q=[1.0], v=0), rt.Effort())
    with pytest.raises(rt.NoSolutionFound) as caught:
        rt.plan(phase, progress=False)
    assert "12 N" in str(caught.value)
    assert "9.8" in str(caught.value)


def test_what_the_proof_allows_passes_the_witness():
    """Proof and witness divide the excess over a two-sided limit by half of its range."""
    arm = rt.load("two_link_arm")
    limits = arm.limits.with_(effort={joint: (-2.0, 30.0) for joint in arm.actuated}, velocity=20.0)
    ends = rt.State(q=[-1.0, 0.5], v=0), rt.State(q=[1.0, -0.5], v=0)
    solution = rt.plan(rt.Phase(arm, (0.05, 9.0), *ends, rt.Duration(), limits=limits), progress=False)
    assert solution.proof.holds
    worst = max((v.relative for v in rt.validate(solution).violations if v.name == "effort limit"), default=0.0)
    assert worst <= max(solution.proof.excess, 1e-2) + 1e-9
    assert rt.validate(solution).passed


def test_work_is_planned_within_one_sided_limits():
    """Slacks of powers start from the largest effort either way, and doubts on accelerations read two sides."""
    robot = rt.load(winch((0.0, 30.0)), limits={"acceleration": {"winch": (-5.0, 15.0)}})
    ends = rt.State(q=[0.0], v=0), rt.State(q=[1.0], v=0)
    objective = rt.objectives.MechanicalWork() + 1e-3 * rt.Effort()
    solution = rt.plan(rt.Phase(robot, 1.5, *ends, objective), progress=False)
    assert rt.validate(solution).passed
    assert str(solution)
    sample = solution.at(np.linspace(0.0, 1.5, 999))
    assert sample.a.min() >= -5.0 - 0.1
