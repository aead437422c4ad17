"""A start as sensors give it may lie outside a position limit by round-off."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt


@pytest.mark.filterwarnings("ignore:.*touch; add rt.CollisionFree")
def test_a_start_a_little_outside_a_limit_is_planned_from() -> None:
    robot = rt.load("ur5")
    start = np.array([-1.1, -1.8, float(robot.limits.position_upper[2]) + 3e-7, -1.2, -1.57, 0.0])
    ends = rt.State(q=start, v=0), rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
    solution = rt.plan(rt.Phase(robot, (0.2, 5.0), *ends, rt.Duration(), self_collision=False))
    assert solution.proof is not None and solution.proof.motion_holds
    np.testing.assert_allclose(solution.at(0.0).q, start, atol=1e-9)


@pytest.mark.filterwarnings("ignore:.*touch; add rt.CollisionFree")
def test_an_end_a_little_outside_a_limit_leaves_room_for_the_solver() -> None:
    """The fixed end determines a coefficient of the last interval, which had no value within the limit."""
    robot = rt.load("ur5")
    limits = robot.limits.with_(position=(-np.pi, np.pi), velocity=0.5)
    start = rt.State(q=[1.57, -1.5707, 0, -1.5707, -1.57, 3.14], v=0)
    end = [-0.808686, -0.860828, 1.910125, -1.044286, 1.166023, -np.pi - 3e-7]
    phase = rt.Phase(robot, (0.1, 60.0), start, rt.State(q=end, v=0), rt.Duration(), limits=limits)
    solution = rt.plan(phase, check=False)
    assert solution.message == "interior point: solved"
    assert sum(step.iterations for step in solution.refinement) < 60
    np.testing.assert_allclose(solution.at(solution.duration).q, end, atol=1e-9)
