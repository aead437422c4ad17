"""Solves with soft friction end early, and each is the guess of the next."""

from __future__ import annotations

from dataclasses import replace

import robotraj as rt
from robotraj.planning.proving.soft_friction import softened
from robotraj.planning.proving.soft_solves import CHANGE, NEARLY, is_guess
from robotraj.solvers.status import Status


def reach() -> rt.Problem:
    robot = rt.load("z1", locked={"jointGripper": 0.0})
    ends = rt.State(q=[0, 1.0, -1.0, 0.2, 0, 0], v=0), rt.State(q=[1.2, 1.8, -1.6, -0.6, 0.8, 0.9], v=0)
    return rt.Problem([rt.Phase(robot, 1.5, *ends, rt.Effort())])


def test_a_solve_ends_with_its_rows_met_where_the_objective_hardly_falls() -> None:
    soft, mesh = softened(reach(), 4.0, [0.1 * 1.5 / 24]), rt.Mesh(24, rt.schemes.RadauIIA(3))
    solver = rt.InteriorPoint(tolerance=1e-6, fallback=None)
    whole = rt.plan(soft, mesh, solver=solver, check=False)
    early = rt.plan(soft, mesh, solver=solver.until_settled(CHANGE), check=False)
    assert early.status is Status.SOLVED
    assert 8 <= early.iterations < whole.iterations
    assert abs(early.objective - whole.objective) < 20 * CHANGE * whole.objective


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
