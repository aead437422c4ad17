"""Walls that close the way: the one without which a path exists is named, in the failure of a plan too."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.fixed_mesh.diagnosis.closed_ways import closed_ways
from robotraj.solvers.status import Status

LEFT, RIGHT = np.array([1.2, -1.2, 1.4, -1.7, -1.57, 0.0]), np.array([-2.0, -1.2, 1.4, -1.7, -1.57, 0.0])
WALL = rt.obstacles.Box((1.4, 0.04, 4.0), (0.98, 0.0, 0.0), name="wall")
SECOND = rt.obstacles.Box((1.4, 0.04, 4.0), (1.1, -0.3, 0.0), name="second")
ASIDE = rt.obstacles.Box((0.1, 0.1, 0.1), (-1.5, 0.0, 0.2), name="aside")


def across(*obstacles: Obstacle, stretched: bool = True) -> rt.Phase:
    """Move an arm whose base turns less than a turn from one side to the other; ``stretched`` it cannot fold."""
    robot = rt.load("ur5")
    bounds = {"shoulder_pan_joint": (-2.2, 2.2)}
    if stretched:
        bounds |= {"shoulder_lift_joint": (-1.4, -0.8), "elbow_joint": (1.0, 1.5)}
    ends = rt.State(q=LEFT, v=0), rt.State(q=RIGHT, v=0)
    limits = robot.limits.with_(position=bounds)
    return rt.Phase(robot, 3.0, *ends, rt.Effort(), [rt.CollisionFree(obstacles)], limits=limits)


def test_the_wall_that_closes_the_way_is_named() -> None:
    (conflict,) = closed_ways(rt.Problem([across(ASIDE, WALL)]))
    assert conflict.name.endswith("and wall")
    assert conflict.needed < -0.01 and not conflict.certain and "that ignores it" in conflict.reason


def test_an_arm_that_folds_finds_a_way() -> None:
    problem = rt.Problem([across(WALL, stretched=False)])
    assert closed_ways(problem) == ()


def test_two_walls_that_each_close_the_way_are_ignored_together() -> None:
    (conflict,) = closed_ways(rt.Problem([across(WALL, SECOND)]))
    assert "ignores all obstacles" in conflict.reason and conflict.needed < -0.01


def test_a_failed_plan_names_the_wall() -> None:
    with pytest.raises(rt.NoSolutionFound, match="no way past wall was found") as failure:
        rt.plan(across(WALL))
    assert failure.value.solution.status is Status.NOT_FOUND


def test_a_wall_is_named_beside_an_obstacle_that_moves() -> None:
    ball = rt.obstacles.Sphere(0.05, lambda t: (-0.6, 0.3 * t, 0.8), name="ball")
    (conflict,) = closed_ways(rt.Problem([across(ball, WALL)]))
    assert conflict.name.endswith("and wall")
