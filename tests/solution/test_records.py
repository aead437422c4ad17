"""Records of a solution: its times and its history."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.records import History, Round, added_times, answered, merged, started_from
from robotraj.solvers.base import Outcome
from robotraj.solvers.status import Status


def test_times_are_added_part_by_part() -> None:
    first, second = (
        {"build": 1.0, "solve": 2.0, "solve: interior point": 0.5},
        {"build": 0.25, "solve": 3.0, "solve: progress": 1.0},
    )
    assert added_times(first, second) == {
        "build": 1.25,
        "solve": 5.0,
        "solve: interior point": 0.5,
        "solve: progress": 1.0,
    }
    assert added_times({}, first) == first


def test_rows_are_held_where_another_solver_took_over_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver gives up once, so that the first answer and the ones with rows between the points have other parts."""
    states = {"x": rt.between(0, 4), "v": rt.between(-2, 2), "a": rt.between(-4, 4)}
    carriage = rt.System(["x", "v", "a"], ["j"], lambda point: [point.x["v"], point.x["a"], point.u["j"]])
    limits = {"states": states, "controls": {"j": rt.between(-40, 40)}}
    phase = rt.Phase(carriage, (0.1, 10), rt.State([0, 0, 0]), rt.State([4, 0, 0]), rt.Duration(), **limits)
    asked: list[Any] = []
    solve = rt.InteriorPoint.solve

    def once_by_ipopt(self: rt.InteriorPoint, *arguments: Any, **named: Any) -> Outcome:
        asked.append(arguments)
        return rt.Ipopt().solve(*arguments, **named) if len(asked) == 1 else solve(self, *arguments, **named)

    monkeypatch.setattr(rt.InteriorPoint, "solve", once_by_ipopt)
    solution = rt.plan(
        phase,
        rt.Mesh(12, rt.schemes.RadauIIA(3)),
        solver=rt.InteriorPoint(),
        interval_limits=rt.interval_limits.ConstraintGeneration(1e-5),
    )
    assert len(asked) > 1 and solution.added_rows and solution.success
    assert {"solve: combinations", "solve: progress"} <= set(solution.times)


@pytest.mark.parametrize("value", [float("nan"), 0.0, -1.0, "small", True, None])
@pytest.mark.parametrize("name", ["error", "excess", "objective"])
def test_goals_are_numbers_above_zero(name: str, value: object) -> None:
    """With a goal of NaN no plan is ever proved."""
    with pytest.raises(rt.InputError, match=rf"Goals\({name}\)"):
        rt.solution.Goals(**{name: value})


def swing_up() -> rt.Phase:
    """Swing a pendulum up."""
    start, end = rt.State(q=0, v=0), rt.State(q=np.pi, v=0)
    return rt.Phase(rt.load("pendulum"), 2.0, start, end, rt.Effort())


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-6}, {"mesh": rt.Mesh(10)}])
def test_the_rounds_of_a_plan_add_up_to_its_effort(options: dict[str, Any]) -> None:
    solution = rt.plan(swing_up(), **options)
    assert sum(each.iterations for each in solution.history) == solution.iterations
    assert sum(each.seconds for each in solution.history) == pytest.approx(solution.seconds, rel=1e-9)
    assert len(solution.history) >= len(solution.refinement)
    assert sum(part.mesh.count for part in solution.phases) in [each.intervals for each in solution.history]


def test_a_round_of_a_proved_plan_has_what_it_lacked_and_the_response() -> None:
    history = rt.plan(swing_up()).history
    assert history[0].lacked.startswith("objective still to gain inf") or "(allowed 1e-03)" in history[0].lacked
    assert history[0].response == f"{history[1].intervals} intervals"
    assert [each.lacked for each in history if each.response == "end"] == [""]
    lines = str(history).splitlines()
    assert len(lines) == 1 + len(history)
    assert lines[0].split()[:4] == ["round", "intervals", "status", "iterations"]


def test_rounds_of_attempts_are_in_the_order_in_which_they_were_solved() -> None:
    first, second, third = (Round(n, Status.SOLVED, 0.0, n, 0.1) for n in (1, 2, 3))
    assert merged((second,), (first, third)) == (first, second, third)


def test_the_start_of_a_plan_is_the_last_one_that_led_to_a_solution() -> None:
    failed, solved, finer = (Round(1, status, 0.0, 1, 0.1) for status in (Status.STALLED, Status.SOLVED, Status.SOLVED))
    rounds = (*started_from((failed,), "guess 1"), *started_from((solved,), "guess 2"), finer)
    assert History(rounds).start == "guess 2"
    assert History(started_from(rounds, "other")).start == "other"
    assert answered(rounds, "excess", "finer mesh")[-1].response == "finer mesh"
    assert History(()).start == ""
