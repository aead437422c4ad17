"""Records of a solution: its times."""

from __future__ import annotations

from typing import Any

import pytest

import robotraj as rt
from robotraj.solution.records import added_times
from robotraj.solvers.base import Outcome


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
