"""Failed plans report the reason and keep the last iterate; plans that start from others need fewer iterations."""

from __future__ import annotations

import os
import re
import signal
import threading
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh import posed
from robotraj.planning.loop import to_tolerance
from robotraj.solvers.base import Iteration

BLOCK = rt.System(
    ["x", "v"],
    ["u"],
    lambda point: [point.x["v"], point.u["u"]],
    units={"x": "m", "v": "m/s", "u": "N"},
    name="block",
)


PARTS = ("solve: functions", "solve: progress", "solve: linear algebra and steps")


def move(**more: Any) -> rt.Phase:
    given = {
        "duration": (0.1, 20),
        "start": rt.State([0, 0]),
        "end": rt.State([10, 0]),
        "controls": {"u": rt.between(-1, 1)},
        "objective": rt.Duration(),
        "name": "move",
    }
    return rt.Phase(BLOCK, **(given | more))


def cartpole() -> rt.Phase:
    rest, up = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    return rt.Phase(rt.load("cartpole"), 2.0, rest, up, rt.Effort(), name="swing up")


def test_a_good_plan_is_solved_and_breaks_nothing() -> None:
    solution = rt.plan(move(), rt.Mesh(), solver=rt.Ipopt())
    assert solution.success and solution.status is rt.solvers.Status.SOLVED
    assert solution.violations() == ()
    assert solution.duration == solution.objective == pytest.approx(2 * np.sqrt(10), abs=1e-5)
    assert solution.iterations > 0 and set(solution.times) == {"build", "compile", "setup", "solve", *PARTS}
    parts = [solution.times[part] for part in PARTS]
    assert min(parts) >= 0 and sum(parts) == pytest.approx(solution.times["solve"])
    assert solution.seconds == pytest.approx(sum(solution.times.values()) - sum(parts))
    assert str(solution).startswith("solved: objective 6.3245")


def test_an_infeasible_problem_raises_with_the_iterate_the_rows_and_a_remedy() -> None:
    """Ten metres in five seconds need more than one newton."""
    with pytest.raises(rt.NoSolutionFound) as caught:
        rt.plan(move(duration=5.0))
    solution = caught.value.solution
    assert solution.status is rt.solvers.Status.INFEASIBLE and not solution.success
    worst = solution.violations(top=1)[0]
    assert worst.label.startswith("defect, ") and worst.phase == "move" and worst.unit in ("m", "m/s")
    assert 0 <= worst.time <= 5.0 and worst.amount > 1e-3
    assert all(part in str(caught.value) for part in ("'move'", "infeasible", str(worst), "try: "))
    # The conflicting limits come first, and the advice last.
    text = " ".join(str(caught.value).split())
    assert text.startswith("'move' was not solved: control bound, u")
    longer = re.search(r"duration: 5 s must become ([\d.]+) s", text)
    least = 2 * np.sqrt(10)  # The least duration, to which the stated one adds some room.
    assert longer is not None and least < float(longer[1]) < 1.05 * least
    assert "iterations" not in text.partition("try: ")[2]
    assert solution.at(2.5).x["x"] == pytest.approx(5, abs=3)
    amounts = [violation.relative for violation in solution.violations(top=100)]
    assert amounts == sorted(amounts, reverse=True)


def test_without_check_the_failed_solution_is_returned() -> None:
    solution = rt.plan(move(duration=5.0), check=False)
    assert not solution.success
    assert len(solution.violations()) == 3


def test_an_infeasible_row_is_named_with_its_unit_and_time() -> None:
    far = rt.PathConstraint(lambda point: point.x["x"] ** 2 + 1, upper=50, name="reach", unit="m^2")
    phase = move(end=rt.State({"x": rt.between(9, 11), "v": 0}), constraints=[far])
    solution = rt.plan(phase, check=False)
    named = [violation for violation in solution.violations(100) if violation.name == "reach"]
    assert named and named[0].unit == "m^2"
    assert str(named[0]).startswith("reach, t = ") and str(named[0]).endswith("m^2 over the limit of 50 m^2")


def test_the_iteration_limit_keeps_the_iterate() -> None:
    solution = rt.plan(cartpole(), solver=rt.Ipopt(max_iterations=3), check=False)
    assert solution.status is rt.solvers.Status.ITERATION_LIMIT
    assert solution.iterations == 3
    assert "max_iterations" in solution.status.remedy
    assert np.isfinite(solution.at(1.0).q).all()


def test_the_time_limit_keeps_the_iterate() -> None:
    solution = rt.plan(cartpole(), rt.Mesh(200), solver=rt.Ipopt(time_limit=1e-3), check=False)
    assert solution.status is rt.solvers.Status.TIME_LIMIT
    assert "time_limit" in solution.status.remedy
    assert np.isfinite(solution.at(1.0).q).all()


def test_a_failed_plan_can_be_continued() -> None:
    stopped = rt.plan(cartpole(), solver=rt.Ipopt(max_iterations=8), check=False)
    assert rt.plan(cartpole(), rt.Mesh(), guess=stopped).objective == pytest.approx(58.8076, abs=1e-4)


def test_an_expression_that_gives_nan_is_reported_as_such() -> None:
    root = rt.PathConstraint(lambda point: ca.sqrt(point.x["x"] - 20), upper=9, name="root")
    solution = rt.plan(move(constraints=[rt.AtStart(root)], start=rt.State({"v": 0})), check=False)
    assert not solution.success
    assert any(violation.name == "root" for violation in solution.violations(1000))


def test_more_rows_than_unknowns_are_called_so() -> None:
    fixed = rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State([1, 0]), controls={"u": 0.0})
    solution = rt.plan(fixed, rt.Mesh(4), check=False)
    assert solution.status in (rt.solvers.Status.OVERDETERMINED, rt.solvers.Status.INFEASIBLE)


def interrupted_by(send: Any) -> rt.Solution:
    """Plan with a solver whose fifth iteration calls ``send``."""

    class Watched(rt.Ipopt):
        def solve(self, nlp: Any, progress: Any = None, multipliers: Any = None) -> Any:
            def watch(iteration: Iteration) -> None:
                if iteration.number == 5:
                    send()

            return super().solve(nlp, watch, multipliers)

    return rt.plan(cartpole(), rt.Mesh(80), solver=Watched(), check=False)


def test_ctrl_c_keeps_the_last_iterate() -> None:
    before = signal.getsignal(signal.SIGINT)
    solution = interrupted_by(lambda: os.kill(os.getpid(), signal.SIGINT))
    assert solution.status is rt.solvers.Status.INTERRUPTED
    assert "guess=solution" in solution.status.remedy
    assert 4 <= solution.iterations <= 8
    assert np.isfinite(solution.at(1.0).q).all()
    assert solution.at(0.0).q == pytest.approx([0, 0], abs=1e-9)
    assert signal.getsignal(signal.SIGINT) is before


def pressed(*_: Any) -> Any:
    raise KeyboardInterrupt


class Pressed(rt.Ipopt):
    """Ctrl-C comes before a solve begins, where no solver waits for it."""

    def solve(self, *_: Any) -> Any:
        raise KeyboardInterrupt


def test_ctrl_c_between_meshes_keeps_what_the_last_one_found(monkeypatch: pytest.MonkeyPatch) -> None:
    solved = to_tolerance.solved_at_points
    with monkeypatch.context() as patch:
        once = iter([solved, pressed])
        patch.setattr(to_tolerance, "solved_at_points", lambda *given: next(once)(*given))
        solution = rt.plan(cartpole(), tolerance=1e-9, check=False)
    assert solution.status is rt.solvers.Status.INTERRUPTED
    assert len(solution.refinement) == 1
    again = rt.plan(cartpole(), rt.Mesh(20, rt.schemes.RadauIIA(3)), guess=solution)
    assert again.objective == pytest.approx(solution.objective, rel=1e-6)
    monkeypatch.setattr(to_tolerance, "assess", pressed)
    assert rt.plan(cartpole(), tolerance=1e-9, check=False).status is rt.solvers.Status.INTERRUPTED


def test_ctrl_c_between_rounds_keeps_what_the_last_one_found(monkeypatch: pytest.MonkeyPatch) -> None:
    held = rt.PathConstraint(lambda p: p.x["x"], upper=0.1)
    phase = rt.Phase(BLOCK, 1.0, rt.State([0, 1]), rt.State([0, -1]), rt.Effort(), constraints=[held])
    mesh, interval_limits = rt.Mesh(5, rt.schemes.RadauIIA(3)), rt.interval_limits.ConstraintGeneration(1e-5)
    assert rt.plan(phase, mesh, interval_limits=interval_limits).added_rows
    monkeypatch.setattr(posed, "with_added_rows", pressed)
    solution = rt.plan(phase, mesh, interval_limits=interval_limits, check=False)
    assert solution.status is rt.solvers.Status.INTERRUPTED
    assert (
        solution.objective
        == rt.plan(phase, mesh, interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0)).objective
    )


@pytest.mark.parametrize(
    "second", [[rt.planning.ContinuationStep(solver=Pressed())], []], ids=["in a stage", "after the stages"]
)
def test_ctrl_c_between_stages_keeps_what_the_last_one_found(second: list[rt.planning.ContinuationStep]) -> None:
    first = rt.planning.ContinuationStep(mesh=rt.Mesh(10), solver=rt.Ipopt())
    solution = rt.plan(cartpole(), rt.Mesh(), solver=Pressed(), continuation=[first, *second], check=False)
    assert solution.status is rt.solvers.Status.INTERRUPTED
    assert [record.status for record in solution.continuation] == [rt.solvers.Status.SOLVED]
    assert solution.objective == rt.plan(cartpole(), rt.Mesh(10), solver=rt.Ipopt()).objective


@pytest.mark.parametrize(
    "options", [{}, {"tolerance": 1e-6}, {"continuation": [rt.planning.ContinuationStep(mesh=rt.Mesh(10))]}]
)
def test_ctrl_c_before_anything_was_found_is_raised(options: dict[str, Any]) -> None:
    with pytest.raises(KeyboardInterrupt):
        rt.plan(cartpole(), solver=Pressed(), check=False, **options)


def test_ctrl_c_from_outside_stops_a_long_solve() -> None:
    """The signal comes from another thread while IPOPT computes."""
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    rest, up = rt.State(q=[0, 0], v=0), rt.State(q=[np.pi, 0], v=0)
    phase = rt.Phase(rt.load("acrobot"), 4.0, rest, up, rt.Effort())

    class Timed(rt.Ipopt):
        def solve(self, nlp: Any, progress: Any = None, multipliers: Any = None) -> Any:
            def watch(iteration: Iteration) -> None:
                if iteration.number == 1:
                    timer.start()

            return super().solve(nlp, watch, multipliers)

    solution = rt.plan(phase, rt.Mesh(500), solver=Timed(), check=False)
    timer.join()
    assert solution.status is rt.solvers.Status.INTERRUPTED


def test_an_error_in_the_progress_callback_is_not_swallowed() -> None:
    def fail() -> None:
        raise ZeroDivisionError("the watcher's own")

    with pytest.raises(ZeroDivisionError, match="the watcher's own"):
        interrupted_by(fail)


@pytest.mark.parametrize(
    "mesh",
    [rt.Mesh(20), rt.Mesh(40), rt.Mesh(25, rt.schemes.Trapezoidal()), rt.Mesh(12, rt.schemes.RadauIIA(points=3))],
    ids=["same", "finer", "trapezoid", "Radau"],
)
@pytest.mark.parametrize("task", [move, cartpole])
def test_a_warm_start_from_another_mesh_and_scheme_takes_fewer_iterations(task: Any, mesh: rt.Mesh) -> None:
    cold = rt.plan(task(), mesh)
    warm = rt.plan(task(), mesh, guess=rt.plan(task(), rt.Mesh(20)))
    assert warm.objective == pytest.approx(cold.objective, rel=1e-5)
    assert warm.iterations < cold.iterations


def test_a_phase_alone_is_a_problem() -> None:
    assert rt.plan(move(), rt.Mesh(10)).objective == rt.plan(rt.Problem([move()]), rt.Mesh(10)).objective


def test_success_is_claimed_only_after_every_row_was_evaluated_again() -> None:
    """The status of a solver that reports success at its guess is checked."""

    class Boaster(rt.Ipopt):
        def solve(self, nlp: Any, progress: Any = None, multipliers: Any = None) -> Any:
            outcome = rt.Ipopt(max_iterations=1).solve(nlp)
            object.__setattr__(outcome, "status", rt.solvers.Status.SOLVED)
            return outcome

    solution = rt.plan(cartpole(), solver=Boaster(), check=False)
    assert solution.status is rt.solvers.Status.ROWS_VIOLATED and solution.violations()


def test_two_phases_joined_are_one_plan() -> None:
    """Half way and the rest take as long as the whole."""
    half = move(end=rt.State({"x": 5}), name="first")
    rest = move(start=None, name="second")
    solution = rt.plan(rt.Problem([half, rest], [rt.Continuity(0, 1)]), rt.Mesh(10))
    assert solution.duration == pytest.approx(2 * np.sqrt(10), abs=1e-5)
    assert solution.phases[1].t0 == pytest.approx(solution.phases[0].duration, abs=1e-8)
    before, after = solution.phases[0].at(solution.phases[1].t0), solution.at(solution.phases[1].t0)
    assert before.x["v"] == pytest.approx(after.x["v"], abs=1e-7)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_the_sliding_mass_takes_the_same_time_in_any_number_of_phases(count: int) -> None:
    """Unit mass, 1 m, 20 N: 2 / sqrt(20) seconds, cut at equal distances."""

    def part(i: int) -> rt.Phase:
        return rt.Phase(
            BLOCK,
            (0.0, 1.0),
            rt.State({"x": i / count, "v": 0.0 if i == 0 else None}),
            rt.State({"x": (i + 1) / count, "v": 0.0 if i == count - 1 else None}),
            rt.Duration(),
            states={"x": rt.between(0, 1), "v": rt.between(0, 10)},
            controls={"u": rt.between(-20, 20)},
            name=f"part {i}",
        )

    problem = rt.Problem([part(i) for i in range(count)], [rt.Continuity(i, i + 1) for i in range(count - 1)])
    solution = rt.plan(problem, rt.Mesh(40 if count % 2 else 20), guess=rt.guess.StraightLine(duration=0.5 / count))
    assert solution.duration == pytest.approx(2 / np.sqrt(20), rel=1e-3 if count == 3 else 1e-6)
