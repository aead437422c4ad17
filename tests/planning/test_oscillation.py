"""Least time under a limit on the tool's speed: proved as written, and unique with a small cost on changes of speed."""

import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

FIRST, LAST = np.array([0, -1.2, 1.4, -1.5, -1.57, 0.0]), np.array([1.4, -0.8, 0.9, -1.2, -1.2, 0.5])


def reach(objective, *constraints):
    arm = rt.load("ur10")
    ends = rt.State(q=FIRST, v=0), rt.State(q=LAST, v=0)
    return rt.Phase(arm, (0.05, 20), *ends, objective, constraints)


@pytest.mark.parametrize(("limit", "angular"), [(0.5, None), (0.3, 0.8)])
def test_least_time_is_proved_as_written_without_teeth(limit, angular):
    phase = reach(rt.Duration(), rt.constraints.FrameSpeed("tool0", linear=limit, angular=angular))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = rt.plan(phase)
    assert solution.proof.holds and solution.proof.is_smooth
    # Six solves on the second mesh, two hundred iterations each, were usual before.
    assert solution.iterations < 400
    unique = rt.plan(phase.with_(objective=rt.Duration() + 1e-3 * rt.objectives.SpeedVariation()))
    assert solution.duration <= unique.duration * (1.0 + 1e-3)


@pytest.mark.parametrize("limit", [0.5, 1.0])
def test_the_limit_of_the_tool_is_proved(limit):
    cost = 1e-3 * rt.objectives.SpeedVariation()
    phase = reach(rt.Duration() + cost, rt.constraints.FrameSpeed("tool0", linear=limit))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = rt.plan(phase)
    assert solution.proof.holds
    model, data, frame = phase.robot.model, phase.robot.model.createData(), phase.robot.frame("tool0")
    sample = solution.at(np.linspace(0.0, solution.duration, 2001))
    speeds = []
    for q, v in zip(sample.q, sample.v, strict=True):
        pin.forwardKinematics(model, data, q, v)
        speeds.append(np.linalg.norm(pin.getFrameVelocity(model, data, frame, pin.LOCAL_WORLD_ALIGNED).linear))
    assert max(speeds) < limit * (1 + 1e-3)
    # The tool moves at its limit nearly all the way, and joints turn back and forth at most once or twice.
    assert np.mean(np.array(speeds) > 0.99 * limit) > 0.8
    changes = np.abs(np.diff(sample.v, axis=0)).sum(axis=0) / phase.robot.limits.velocity
    assert (changes < 6.0).all()


def test_its_value_is_the_variation_of_the_speed():
    """1 kg from rest to rest under 1 N over 4 m: r is 1 / v_max for 2 s, then -1 / v_max; v_max counts as 1 if free."""
    block, c = rt.load("block"), 0.1
    cost = 1e-3 * rt.objectives.SpeedVariation(smoothing=c)
    solution = rt.plan(rt.Phase(block, (0.1, 20), rt.State(q=0, v=0), rt.State(q=4.0, v=0), rt.Duration() + cost))
    r = 1.0 / min(block.limits.velocity[0], 1.0)
    assert solution.objective - solution.duration == pytest.approx(4e-3 * (np.hypot(r, c) - c), rel=5e-2)


@pytest.mark.parametrize("smoothing", [0.0, np.inf])
def test_smoothing_is_positive(smoothing):
    with pytest.raises(rt.InputError, match="smoothing"):
        reach(rt.objectives.SpeedVariation(smoothing=smoothing))
