"""Solves with soft friction end early, and each is the guess of the next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.proving.best_motion import BestMotion
from robotraj.planning.proving.prove import ENOUGH_OF_POWERS
from robotraj.planning.proving.soft_friction import softened
from robotraj.planning.proving.soft_solves import CHANGE, NEARLY, is_guess
from robotraj.solvers.status import Status


def reach() -> rt.Problem:
    robot = rt.load("z1", locked={"jointGripper": 0.0})
    ends = rt.State(q=[0, 1.0, -1.0, 0.2, 0, 0], v=0), rt.State(q=[1.2, 1.8, -1.6, -0.6, 0.8, 0.9], v=0)
    return rt.Problem([rt.Phase(robot, 1.5, *ends, rt.Effort())])


def test_solves_end_with_their_rows_met_where_the_objective_hardly_falls() -> None:
    solver, mesh, counts = rt.InteriorPoint(tolerance=1e-6, fallback=None), rt.Mesh(24, rt.schemes.RadauIIA(3)), []
    for duration in (1.2, 1.5, 2.0):
        soft = softened(rt.Problem([reach().phases[0].with_(duration=duration)]), 4.0, [0.1 * duration / 24])
        whole = rt.plan(soft, mesh, solver=solver, check=False)
        early = rt.plan(soft, mesh, solver=solver.until_settled(CHANGE), check=False)
        assert early.status is Status.SOLVED
        assert 8 <= early.iterations <= whole.iterations
        assert abs(early.objective - whole.objective) < 20 * CHANGE * whole.objective
        counts.append((early.iterations, whole.iterations))
    # A single solve may end at the same iteration, as its last ones may gain much.
    assert np.sum(counts, axis=0)[0] < np.sum(counts, axis=0)[1]


def test_an_iterate_at_the_limit_of_iterations_is_a_guess_where_its_rows_nearly_hold() -> None:
    block = rt.Phase(rt.load("block"), 3.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    solved = rt.plan(block, mesh=rt.Mesh(4))
    assert is_guess(solved)
    ended = replace(solved, status=Status.ITERATION_LIMIT)
    assert is_guess(ended)
    failed = rt.plan(block.with_(duration=1e-3), mesh=rt.Mesh(4), check=False)
    assert not is_guess(failed)
    far = failed.violations(1)[0]
    assert far.relative > NEARLY
    assert not is_guess(replace(ended, violation_list=(far,)))
    assert is_guess(replace(ended, violation_list=(replace(far, amount=0.5 * NEARLY * far.size),)))


def test_a_plan_by_early_ended_guesses_is_proved() -> None:
    solution = rt.plan(reach(), check=False, progress=False)
    assert solution.success
    assert solution.proof is not None
    assert solution.proof.holds


def test_works_with_dry_friction_are_limited_between_the_points_from_the_second_mesh(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A proved motion ends on the third mesh with the robot's own friction."""
    robot = replace(rt.load("two_link_arm"), friction=np.full(2, 0.5))
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.8, -0.5], v=0)
    limited: list[bool] = []
    real = BestMotion.solve

    def recorded(self, *given, **named):  # type: ignore[no-untyped-def]
        limited.append(self.limits_between)
        return real(self, *given, **named)

    monkeypatch.setattr(BestMotion, "solve", recorded)
    limits = robot.limits.with_(effort=20.0, velocity=6.0)
    solution = rt.plan(rt.Phase(robot, 2.0, *ends, rt.objectives.MechanicalWork(), limits=limits))
    assert limited[:2] == [False, True][: len(limited)]
    # A better solution from the plan itself is a further step on the same mesh.
    assert len({step.intervals for step in solution.refinement}) <= ENOUGH_OF_POWERS
    assert solution.proof is not None and solution.proof.motion_holds
