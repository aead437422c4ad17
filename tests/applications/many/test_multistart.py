"""Multistart: distinct optima are distinguished, counted and ranked, identically on any executor."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.fixed_mesh import starts
from robotraj.solvers import interior_point


def two_ways(cost_of_left: float = 1.0) -> rt.Phase:
    """Paths past a disc of radius 1 at the origin: left (y > 0) and right are optima, of which left costs more."""
    system = rt.System(["x", "y"], ["u", "w"], lambda point: [point.u["u"], point.u["w"]])
    return rt.Phase(
        system,
        duration=1.0,
        start=rt.State([-2, 0.01]),
        end=rt.State([2, 0.01]),
        states={"y": rt.between(-3, 3)},
        objective=rt.Effort() + rt.Lagrange(lambda point: cost_of_left * point.x["y"]),
        constraints=[rt.PathConstraint(lambda p: p.x["x"] ** 2 + p.x["y"] ** 2, lower=1.0, name="obstacle")],
    )


def search(phase: rt.Phase, **options: object) -> rt.applications.Multistart:
    with ThreadPoolExecutor(1) as here:
        return rt.multistart(phase, **({"starts": 8, "mesh": rt.Mesh(12), "executor": here} | options))


def test_both_ways_are_found_counted_and_ranked() -> None:
    found = search(two_ways())
    right, left = found.optima
    assert right.objective < left.objective
    assert right.solution.at(0.5).x["y"] < -0.9 and left.solution.at(0.5).x["y"] > 0.9
    numbers = sorted([*right.starts, *left.starts])
    assert len(set(numbers)) == len(numbers)
    assert len(numbers) + sum(found.failures.values()) == found.starts == 8
    assert found.best is right.solution
    assert "2 distinct local optima" in str(found)


def test_mirror_images_of_equal_cost_are_two_optima() -> None:
    system = two_ways(0.0)
    even = rt.Phase(
        system.subject,
        duration=1.0,
        start=rt.State([-2, 0]),
        end=rt.State([2, 0]),
        states=system.states,
        objective=rt.Effort(),
        constraints=system.constraints,
    )
    found = search(even, guess=rt.guess.Perturbed(rt.guess.StraightLine(), (7,), 0.3))
    costs = [optimum.objective for optimum in found.optima]
    assert len(costs) == 2
    assert costs[0] == pytest.approx(costs[1], rel=1e-6)


def test_a_convex_problem_has_one_optimum() -> None:
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    phase = rt.Phase(system, duration=1.0, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.Effort())
    found = search(phase, spread=1.0)
    assert [len(optimum.starts) for optimum in found.optima] == [8]
    assert found.best.objective == pytest.approx(12.0, rel=1e-8)
    assert "1 distinct local optimum" in str(found)


def test_failures_are_counted_by_status() -> None:
    found = search(two_ways(), solver=rt.Ipopt(max_iterations=2))
    assert found.failures == {rt.solvers.Status.ITERATION_LIMIT: 8}
    assert found.optima == ()
    with pytest.raises(InputError, match="None of the 8 starts"):
        _ = found.best
    assert "failed, iteration limit: 8" in str(found)


def test_seeds_decide_the_answer() -> None:
    one, same, other = (search(two_ways(), seed=seed) for seed in (1, 1, 2))
    assert str(one) == str(same)
    assert [o.starts for o in one.optima] != [o.starts for o in other.optima]


def test_starts_share_a_transcription_and_the_compiled_program(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    for module, name in ((starts, "transcribe"), (interior_point, "formulate")):
        original = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *a, f=original, n=name, **k: made.append(n) or f(*a, **k))
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], ca.sin(point.u["u"])])
    phase = rt.Phase(system, duration=1.0, start=rt.State([0, 0]), end=rt.State([0.1, 0]), objective=rt.Effort())
    found = search(phase, solver=rt.InteriorPoint(fallback=None))
    assert sum(len(optimum.starts) for optimum in found.optima) > 1
    assert sorted(made) == ["formulate", "transcribe"]


@pytest.mark.parametrize("solver", [rt.InteriorPoint(), rt.Ipopt()])
def test_a_start_ends_where_it_would_alone(solver: rt.solvers.Solver) -> None:
    phase = two_ways()
    found = search(phase, solver=solver)
    assert found.iterations > 0
    for optimum in found.optima:
        for number in {optimum.starts[0], optimum.starts[-1]}:
            guess = (
                rt.guess.StraightLine()
                if number == 0
                else rt.guess.Perturbed(rt.guess.StraightLine(), (0, number), 0.2)
            )
            alone = rt.plan(phase, rt.Mesh(12), guess, solver, check=False)
            assert alone.objective == pytest.approx(optimum.objective, rel=1e-6)


def test_what_starts_share_is_of_one_problem_on_one_mesh() -> None:
    phase = two_ways()
    shared = starts.Shared(rt.guess.StraightLine())
    start = starts.Start(rt.guess.StraightLine(), shared)
    for mesh in (rt.Mesh(12), rt.Mesh(10), rt.Mesh(12)):
        solution = rt.plan(phase, mesh, start, rt.InteriorPoint())
        fresh = rt.plan(phase, mesh, rt.guess.StraightLine(), rt.InteriorPoint())
        assert len(solution.phases[0].knots) == len(mesh.knots)
        assert solution.objective == pytest.approx(fresh.objective, rel=1e-9)
    dearer = rt.plan(two_ways(3.0), rt.Mesh(12), start, rt.InteriorPoint())
    assert dearer.objective != pytest.approx(solution.objective, rel=1e-3)


def test_patience_ends_the_search_at_the_same_start_on_any_executor() -> None:
    every = search(two_ways(), starts=12)
    lowest = every.optima[0].starts[0]
    found = search(two_ways(), starts=12, patience=3)
    assert found.starts == lowest + 4 < 12
    assert found.best.objective == pytest.approx(every.best.objective, rel=1e-8)
    with ThreadPoolExecutor(3) as threads:
        assert str(search(two_ways(), starts=12, patience=3, executor=threads)) == str(found)


@pytest.mark.slow
def test_the_executor_does_not() -> None:
    with ThreadPoolExecutor(2) as threads, ProcessPoolExecutor(2, get_context("spawn")) as processes:
        found = [search(two_ways(), executor=executor) for executor in (threads, processes)]
    reference = search(two_ways())
    for result in found:
        assert str(result) == str(reference)
        for mine, known in zip(result.optima, reference.optima, strict=True):
            np.testing.assert_array_equal(
                mine.solution.phases[0].trajectory.u.values, known.solution.phases[0].trajectory.u.values
            )


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(InputError, match="at least 1 start"):
        rt.multistart(two_ways(), starts=0)
    with pytest.raises(InputError, match="patience of at least 1"):
        rt.multistart(two_ways(), patience=0)
    with pytest.raises(InputError, match="check="):
        rt.multistart(two_ways(), check=True)
    with pytest.raises(InputError, match="got int"):
        rt.multistart(3)


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        *(("starts", value) for value in (2.5, "3", True)),
        *(("seed", value) for value in ("a", 1.5, -1, None)),
        *(("patience", value) for value in (1.5, "a")),
        ("spread", "wide"),
        *((name, value) for name in ("objective_tolerance", "trajectory_tolerance") for value in (-1.0, "a", np.nan)),
    ],
)
def test_arguments_that_are_no_numbers_are_refused(argument: str, value: Any) -> None:
    with pytest.raises(InputError, match=f"rt.multistart .*{argument.rstrip('s')}.*{value!r}"):
        rt.multistart(two_ways(), **{argument: value})


@pytest.mark.slow
def test_cartpole_has_two_optima_and_the_solver_finds_the_higher_one_from_a_straight_line() -> None:
    swing_up = rt.Phase(
        rt.load("cartpole"),
        duration=2.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=[1.0, np.pi], v=0),
        objective=rt.Effort(),
    )
    found = search(swing_up, starts=20, mesh=rt.Mesh(40))
    best, known = found.optima[:2]
    # References, from another implementation on finer meshes; Hermite-Simpson at 40 intervals errs by 5e-6.
    assert best.objective == pytest.approx(57.94478030, rel=1e-5)
    assert known.objective == pytest.approx(58.8076675, rel=1e-5)
    assert 0 in known.starts and 0 not in best.starts
    assert len(best.starts) >= 3 and len(known.starts) >= 3
    times = np.linspace(0.0, 2.0, 401)
    assert best.solution.at(times).q[:, 0].min() == pytest.approx(-0.1035, abs=1e-3)
    assert known.solution.at(times).q[:, 0].max() == pytest.approx(1.1792, abs=1e-3)
    assert "57.945" in str(found) and "58.807" in str(found)


class PressesCtrlC(rt.Ipopt):
    """Sends the signal at its fourth solve, from the thread that solves."""

    def solve(self, nlp: Any, progress: Any = None, multipliers: Any = None) -> Any:
        solved.append(nlp)
        if len(solved) == 4:
            os.kill(os.getpid(), signal.SIGINT)
        return super().solve(nlp, progress, multipliers)


solved: list[Any] = []


def test_ctrl_c_keeps_the_optima_that_were_found() -> None:
    solved.clear()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(rt.applications.Interrupted) as stopped:
            search(two_ways(), solver=PressesCtrlC(), starts=30)
    finally:
        signal.signal(signal.SIGINT, before)
    found = stopped.value.result
    assert found.starts == len(stopped.value.found)
    assert 1 <= found.starts < 30
    assert found.left == 30 - found.starts
    assert found.best.success
    assert f"interrupted with {found.left} starts to go" in str(found)
    assert not search(two_ways(), starts=2).left
