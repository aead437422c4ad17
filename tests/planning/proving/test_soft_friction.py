"""Which problems are solved with softer friction first, and what is softened."""

from __future__ import annotations

import pytest

import robotraj as rt
from robotraj.planning.proving.soft_friction import needs_softening, softened


def problem(name: str, objective: rt.objectives.Objective) -> rt.Problem:
    robot = rt.load(name)
    return rt.Problem([rt.Phase(robot, 1.0, rt.State(q=robot.neutral, v=0), rt.State(v=0), objective)])


@pytest.mark.parametrize(
    ("name", "objective", "needed"),
    [("z1", rt.Effort(), True), ("z1", rt.Duration(), False), ("ur5", rt.Effort(), False)],
)
def test_integrals_over_motions_with_dry_friction_need_it(
    name: str, objective: rt.objectives.Objective, needed: bool
) -> None:
    assert needs_softening(problem(name, objective)) is needed


def test_only_the_speed_of_friction_is_changed() -> None:
    given = problem("z1", rt.Effort())
    (soft,), (hard,) = (each.phases for each in (softened(given, 10.0), given))
    assert soft.robot.friction_speed == 10 * hard.robot.friction_speed
    assert (soft.robot.friction == hard.robot.friction).all()
    assert soft.with_(subject=hard.subject).duration_bounds == hard.duration_bounds
