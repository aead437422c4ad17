"""The chart of the distance to obstacles, against the compiled tree of spheres and a closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.clearance.sphere_tree import sphere_tree
from robotraj.replay_page.charts.curves import curves
from robotraj.robot.collision.robot_spheres import robot_spheres
from robotraj.solution.cycles.gait_cycles import gait_cycles


def distance_chart(plan: Any) -> dict[str, Any]:
    (found,) = [chart for chart in curves(gait_cycles(plan)) if chart["title"] == "Distance to obstacles"]
    return dict(found)


def test_distances_are_those_of_the_compiled_tree(ur5: Any, wave_plan: Callable[..., Any]) -> None:
    obstacles = [
        rt.obstacles.Box((0.3, 0.2, 0.4), position=(0.6, 0.3, 0.2), quaternion=(0.0, 0.0, 0.6, 0.8)),
        rt.obstacles.Capsule(0.1, 0.5, position=(-0.5, 0.4, 0.6)),
    ]
    constraint = rt.CollisionFree(obstacles, margin=0.05, self_collision=False)
    plan = wave_plan(ur5, 3.0, constraints=[constraint])
    (piece,) = distance_chart(plan)["pieces"]
    assert piece["lower"] == [0.05] and piece["upper"] == [None]
    spheres = robot_spheres(ur5)
    tree = sphere_tree(ur5, spheres, np.zeros((0, 2), dtype=int), obstacles)
    times = np.array(piece["t"])
    exact = tree.clearances(plan.phases[0].at(times).q.ravel())
    np.testing.assert_allclose(piece["y"][0], exact, rtol=1e-4, atol=2e-5)


def test_a_moving_obstacle_is_where_it_is_at_that_time(ur5: Any, wave_plan: Callable[..., Any]) -> None:
    """A ball that rises from far below: the distance falls by its speed, as long as the nearest link is the base's."""
    ball = rt.obstacles.Sphere(0.1, position=lambda t: (0.0, 0.0, -100.0 + 2.0 * t))
    plan = wave_plan(ur5, 3.0, amplitude=0.0, constraints=[rt.CollisionFree([ball], self_collision=False)])
    (piece,) = distance_chart(plan)["pieces"]
    slope = np.polyfit(piece["t"], piece["y"][0], 1)[0]
    assert slope == pytest.approx(-2.0, rel=1e-3)


def test_there_is_no_chart_without_obstacles_in_the_world(ur5: Any, wave_plan: Callable[..., Any]) -> None:
    carried = rt.obstacles.Box((0.1, 0.1, 0.1), position=(0.0, 0.0, 0.1), frame="tool0")
    for constraints in ([], [rt.CollisionFree([])], [rt.CollisionFree([carried])]):
        titles = [chart["title"] for chart in curves(gait_cycles(wave_plan(ur5, 3.0, constraints=constraints)))]
        assert "Distance to obstacles" not in titles
