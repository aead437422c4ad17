"""A plan whose objective has settled is a local optimum: no further solve from it, on a mesh no finer, gains."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.loop import run as loop
from robotraj.planning.loop.local_optimum import gain_from
from robotraj.planning.loop.state import Found, PlanState, Task
from robotraj.solvers.status import Status

Pair = tuple[rt.Solution, rt.Solution]

EARLY = rt.InteriorPoint(tolerance=0.1)
"""A solver that stops half a percent above the optimum, on every mesh alike."""


def reach() -> rt.Phase:
    start, end = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0), rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
    return rt.Phase(rt.load("ur5"), 1.0, start, end, rt.Effort())


@pytest.fixture(scope="module")
def optimum() -> float:
    return rt.plan(reach(), mesh=rt.Mesh.chebyshev(80)).objective


def first_and_last(monkeypatch: pytest.MonkeyPatch, solver: rt.solvers.Solver | None) -> Pair:
    """Return the first solution of a plan, and the last one before it is solved once more."""
    found: list[Pair] = []

    def kept(state: PlanState, progress: object) -> Found:
        assert state.first is not None and state.best is not None
        found.append((state.first.solution, state.best.solution))
        return Found(state.best.solution)

    monkeypatch.setattr(loop, "_again", kept)
    monkeypatch.setattr(loop, "is_converged", lambda *_: False)
    rt.plan(reach(), solver=solver)
    return found[0]


def test_a_further_solve_gains_nothing_from_an_optimum(monkeypatch: pytest.MonkeyPatch) -> None:
    first, last = first_and_last(monkeypatch, None)
    found, share = gain_from(last, first, rt.solution.Goals(), rt.InteriorPoint(tolerance=1e-6))
    assert found.status is Status.SOLVED and share == 0.0


def test_a_further_solve_gains_what_solves_that_stopped_early_have_missed(
    monkeypatch: pytest.MonkeyPatch, optimum: float
) -> None:
    first, last = first_and_last(monkeypatch, EARLY)
    missed = last.objective / optimum - 1.0
    assert last.proof is not None and last.proof.unsettled < 1e-6 and missed > 4e-3
    assert gain_from(last, first, rt.solution.Goals(), EARLY)[1] == pytest.approx(missed, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "objective", "again"),
    [(None, rt.Effort(), False), (EARLY, rt.Effort(), True), (None, rt.objectives.MechanicalWork(), True)],
    ids=["converged", "large tolerance", "ended where the objective hardly changes"],
)
def test_a_plan_is_solved_once_more_only_where_its_solver_stopped_early(
    solver: rt.solvers.Solver | None,
    objective: rt.objectives.Objective,
    again: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tasks: list[Task] = []
    plain = loop.solved

    def solved(state: PlanState, *given: Any) -> Found:
        tasks.append(state.task)
        return plain(state, *given)

    monkeypatch.setattr(loop, "solved", solved)
    solution = rt.plan(reach().with_(objective=objective), solver=solver, check=False)
    assert solution.proof is not None and solution.proof.holds
    assert (Task.AGAIN in tasks) is again


@pytest.mark.parametrize("tolerance", [1e-6, 1e-2, 1e-1])
def test_plans_that_are_proved_are_optimal_whatever_the_tolerance_of_the_solver(
    optimum: float, tolerance: float
) -> None:
    solution = rt.plan(reach(), solver=rt.InteriorPoint(tolerance=tolerance))
    assert solution.proof is not None and solution.proof.holds
    assert solution.objective == pytest.approx(optimum, rel=1e-3)


def test_the_proof_claims_this_local_optimum_alone() -> None:
    assert "objective still to gain in this local optimum" in " ".join(str(rt.plan(reach()).proof).split())


def test_a_plan_whose_gain_is_not_found_on_its_own_mesh_has_not_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = loop.solved

    def solved(state: PlanState, *given: Any) -> Found:
        found = plain(state, *given)
        lost = replace(found.solution, status=Status.ITERATION_LIMIT)
        return Found(lost) if state.task is Task.BETTER else found

    monkeypatch.setattr(loop, "solved", solved)
    solution = rt.plan(reach(), solver=EARLY)
    assert solution.proof is not None and solution.proof.motion_holds and not solution.proof.holds
    assert solution.proof.unsettled > 1e-3 and np.isfinite(solution.proof.unsettled)
