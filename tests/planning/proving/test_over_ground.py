"""Plans keep all links above the ground, by heights that plain trigonometry gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.status import Status
from tests.robots.bag import bag_robot, crouch


def lowest_corner(found: rt.Solution, bag: float) -> float:
    """Return the least height of the box's corners [m]."""
    q = found.phases[0].at(np.linspace(0.0, 1.0, 1001)).q
    corners = [(x, z) for x in (-0.17, -0.07) for z in (-0.05 - bag / 2, -0.05 + bag / 2)]
    return float(np.min([q[:, 1] - x * np.sin(q[:, 2]) + z * np.cos(q[:, 2]) for x, z in corners]))


def test_a_plan_leans_to_keep_its_box_above_the_ground(tmp_path: Path) -> None:
    """The least effort with a box of 0.9 m is larger than with one of 0.1 m, whose motion lets it pass below."""
    small, large = (rt.plan(crouch(bag_robot(tmp_path, bag), 0.3)) for bag in (0.1, 0.9))
    assert lowest_corner(small, 0.9) < -0.05
    assert large.proof is not None
    assert large.proof.holds
    assert lowest_corner(large, 0.9) > -1e-4
    assert large.objective > 1.01 * small.objective
    assert rt.validate(large).passed


def test_a_box_that_clears_the_ground_costs_nothing(tmp_path: Path) -> None:
    """A plan that does not come near the ground has no rows and no iterations more."""
    small, medium = (rt.plan(crouch(bag_robot(tmp_path, bag), 0.3)) for bag in (0.1, 0.3))
    assert medium.iterations == small.iterations
    assert medium.objective == small.objective


def test_an_end_with_a_link_below_the_ground_is_not_proved(tmp_path: Path) -> None:
    """Upright, the box of 0.9 m is 0.2 m below the ground at the end; the solution names the link."""
    found = rt.plan(crouch(bag_robot(tmp_path, 0.9), 0.3, pitch=0.0), check=False)
    assert found.status is not Status.SOLVED
    assert "body" in str(found.cause)


@pytest.mark.slow
def test_a_round_foot_clears_a_stair_by_its_ball() -> None:
    """The corners of the box around a tilted foot's ball are below the ground on which the ball stands."""
    robot = rt.load("five_link", root="planar")
    found = rt.plan(rt.gait.stairs(robot, start=0.2, run=0.4, rise=0.08, count=1))
    assert any(each.lacked == "links below the ground" for each in found.rounds)
    assert found.proof is not None
    assert found.proof.holds
    assert rt.validate(found).passed
