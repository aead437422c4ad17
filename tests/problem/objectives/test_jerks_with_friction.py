"""Jerks of arms whose joints have dry friction: torques need not be continuous."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt


def reach(duration: object, objective: object) -> rt.Phase:
    robot = rt.load("xarm7")
    start, end = np.array([0, -0.5, 0, 0.8, 0, 1.2, 0]), np.array([1.2, 0.3, -0.6, 1.6, 0.5, 0.6, 0.8])
    return rt.Phase(robot, duration, rt.State(q=start, v=0), rt.State(q=end, v=0), objective)


def test_least_jerk_is_the_polynomial_of_each_joint() -> None:
    phase = reach(1.5, rt.objectives.Jerk())
    assert np.all(phase.robot.friction > 0.0)
    solution = rt.plan(phase)
    # Accelerations at the ends are free, so jerks vanish there: q''' = c s (1 - s), and the cost is 120 d^2 / T^5.
    step = np.array(phase.end_bounds.lower[:7]) - np.array(phase.start_bounds.lower[:7])
    assert solution.proof is not None and solution.proof.holds
    assert solution.objective == pytest.approx(float(120 * np.sum(step**2) / 1.5**5), rel=1e-6)


@pytest.mark.parametrize("objective", [rt.Effort() + 1e-4 * rt.objectives.Jerk()], ids=str)
def test_effort_and_jerk_are_proved_and_pass_validation(objective: rt.objectives.Objective) -> None:
    solution = rt.plan(reach(1.5, objective))
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed
