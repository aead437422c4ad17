"""Speed limits of legs are narrowed step by step, down to a motion or to the joints that must turn faster."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.relaxation.narrowed_speeds import narrowed_speeds
from robotraj.planning.settings import resolve


def leap(speed: float) -> rt.Problem:
    """Return a jump of five_link, whose joints turn at most this fast [rad/s]."""
    robot = rt.load("five_link", root="planar")
    speeds = np.where(np.isfinite(robot.limits.velocity), speed, np.inf)
    return rt.gait.jump(replace(robot, limits=robot.limits.with_(velocity=speeds)), height=0.2)


def coarse(problem: rt.Problem) -> CoarseSolves:
    return CoarseSolves(resolve(problem, {}, None))


def test_a_jump_within_the_limits_is_found() -> None:
    problem = leap(30.0)
    conflicts, motion = narrowed_speeds(problem, coarse(problem))
    assert not conflicts and motion is not None and motion.success
    robot = problem.phases[0].robot
    assert robot is not None
    for part in motion.phases:
        speeds = part.trajectory.x(part.points)[:, robot.nq + 3 :]
        assert np.abs(speeds).max() <= 30.0 * (1.0 + 1e-6)


def test_joints_that_must_turn_faster_are_named_with_speeds_that_suffice() -> None:
    problem = leap(4.0)
    conflicts, motion = narrowed_speeds(problem, coarse(problem))
    assert motion is None and conflicts
    assert all(conflict.name.startswith("velocity limit, ") and conflict.needed > 4.0 for conflict in conflicts)
    assert len({conflict.name for conflict in conflicts}) == len(conflicts)
    assert not any(conflict.certain for conflict in conflicts)
    enough = leap(max(conflict.needed for conflict in conflicts))
    assert rt.plan(enough).success


def test_nothing_is_solved_without_limits_of_speeds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CoarseSolves, "solve", lambda *_: pytest.fail("a problem was solved"))
    robot = rt.load("five_link", root="planar")
    problem = rt.gait.jump(replace(robot, limits=robot.limits.with_(velocity=np.inf)), height=0.2)
    assert narrowed_speeds(problem, coarse(problem)) == ((), None)
