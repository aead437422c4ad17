"""Rows that a file cannot save, the solution inside an error, and the sign of a cost are kept."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt


@pytest.fixture(scope="module")
def swing_up() -> rt.Phase:
    cap = rt.PathConstraint(lambda point: point.tau[0], lower=-15, upper=15, name="force cap", unit="N")
    start, end = rt.State(q=0, v=0), rt.State(q=[1, np.pi], v=0)
    return rt.Phase(rt.load("cartpole"), 2.0, start, end, rt.Effort(), constraints=[cap])


@pytest.fixture(scope="module")
def solution(swing_up: rt.Phase) -> rt.Solution:
    return rt.plan(swing_up, mesh=rt.Mesh(40))


def test_rows_that_a_file_cannot_keep_are_not_passed(solution: rt.Solution, swing_up: rt.Phase, tmp_path: Path) -> None:
    assert rt.validate(solution, drift=1e-2).passed
    path = solution.save(tmp_path / "cap.npz")
    with pytest.warns(UserWarning, match="force cap"):
        loaded = rt.load_solution(path)
    report = rt.validate(loaded, drift=1e-2)
    assert not report.passed and "force cap" in report.unchecked[0]
    with pytest.raises(rt.ValidationFailed, match="force cap"):
        report.check()
    with pytest.warns(UserWarning, match="force cap"):
        again = rt.load_solution(loaded.save(tmp_path / "again.npz"))
    assert not rt.validate(again).passed
    assert rt.validate(rt.load_solution(path, problem=swing_up), drift=1e-2).passed


def test_an_error_crosses_processes_with_its_solution() -> None:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    move = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([9, 0]), controls={"u": rt.between(-1, 1)})
    failed = rt.plan(move, mesh=rt.Mesh(4), check=False)
    error = pickle.loads(pickle.dumps(rt.NoSolutionFound("no way", failed.status)))
    assert str(error) == "no way" and error.solution is failed.status is rt.solvers.Status.INFEASIBLE


def test_objectives_subtract_negate_and_divide() -> None:
    block = rt.load("block")
    ends = rt.State(q=0, v=0), rt.State(q=1, v=0)
    for objective in (
        rt.Effort() / 2,
        3 * rt.Effort() - 2.5 * rt.Effort(),
        -(-0.5 * rt.Effort()),
        0.5 * rt.Effort() + 0,
    ):
        plan = rt.plan(rt.Phase(block, 4.0, *ends, objective), mesh=rt.Mesh(5))
        assert plan.objective == pytest.approx(0.5 * 12 / 4**3, rel=1e-9)
    with pytest.raises(rt.InputError, match="divided"):
        rt.Effort() / 0


def test_a_plan_on_one_mesh_prints_its_error_between_the_knots(solution: rt.Solution) -> None:
    assert "error between knots" in str(solution)
    finer = rt.plan(solution.problem, mesh=rt.Mesh(80), guess=solution)
    assert solution.error is not None and finer.error is not None
    assert finer.error == pytest.approx(solution.error / 2**4, rel=0.3)


def test_no_times_give_no_rows(solution: rt.Solution) -> None:
    pendulum = rt.Phase(rt.load("pendulum"), 1.5, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    proved = rt.plan(pendulum)
    assert solution.at([]).q.shape == (0, 2)
    assert proved.at([]).q.shape == proved.at([]).tau.shape == (0, 1)
