"""Keep-out circles that are small beside the motion hold between the points."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt

RADIUS = 0.01
ZONE = rt.PathConstraint(lambda p: p.x["x"] ** 2 + p.x["y"] ** 2, lower=RADIUS**2, name="zone")


def point(goal: float) -> rt.Phase:
    def rates(p: Any) -> list[Any]:
        return [p.x["vx"], p.x["vy"], p.u["ax"], p.u["ay"]]

    body = rt.System(["x", "y", "vx", "vy"], ["ax", "ay"], rates)
    effort = rt.Lagrange(lambda p: p.u["ax"] ** 2 + p.u["ay"] ** 2)
    return rt.Phase(body, 2.0, rt.State([-1, 5e-4, 0, 0]), rt.State([goal, 0, 0, 0]), effort, constraints=[ZONE])


@pytest.mark.parametrize("goal", [1.0, 1.3])
def test_a_point_does_not_cross_a_small_circle_between_its_points(goal: float) -> None:
    solution = rt.plan(point(goal))
    assert solution.success
    motion = solution.at(np.linspace(0.0, 2.0, 20001))
    # Rows of the state are imposed where they are violated by more than 5e-4 of their size, 0.01 m^2.
    assert np.hypot(motion.x["x"], motion.x["y"]).min() > 0.97 * RADIUS


def test_the_witness_finds_a_crossed_small_circle() -> None:
    """On a mesh of five intervals and no rows between their points the motion crosses the circle."""
    interval_limits = rt.interval_limits.ConstraintGeneration(rounds=0)
    solution = rt.plan(point(1.3), mesh=rt.Mesh(5), interval_limits=interval_limits)
    motion = solution.at(np.linspace(0.0, 2.0, 20001))
    assert np.hypot(motion.x["x"], motion.x["y"]).min() < 0.5 * RADIUS
    report = rt.validate(solution)
    assert not report.passed and "zone" in str(report)
