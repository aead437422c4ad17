"""The cheapest candidate, against closed forms: a block moved by least effort costs 12 / T^3."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])


def move(time: float, **options: Any) -> rt.Phase:
    return rt.Phase(BLOCK, time, rt.State([0, 0]), rt.State([1, 0]), rt.Effort(), **options)


def test_the_cheapest_has_the_least_objective_and_the_others_follow() -> None:
    moves = {"fast": move(1.0), "slow": move(2.0), "middle": move(1.5)}
    with ThreadPoolExecutor(1) as here:
        found = rt.applications.cheapest(moves, executor=here, mesh=rt.Mesh(10))
    assert found.best == "slow" and list(found.costs) == ["slow", "middle", "fast"]
    for name, time in (("fast", 1.0), ("slow", 2.0), ("middle", 1.5)):
        assert found.costs[name] == pytest.approx(12.0 / time**3, rel=1e-6)
    assert found.solution is found.found["slow"]
    assert str(found).splitlines()[0] == "slow: 1.5"


def test_candidates_without_a_motion_are_named_and_do_not_count() -> None:
    weak = move(1.0, controls={"u": rt.between(-1.0, 1.0)})
    with ThreadPoolExecutor(1) as here:
        found = rt.applications.cheapest({"weak": weak, "strong": move(1.0)}, executor=here, mesh=rt.Mesh(10))
        assert found.best == "strong" and "weak" not in found.costs and "weak: " in str(found)
        with pytest.raises(rt.NoSolutionFound, match="None of the candidates was solved: weak"):
            rt.applications.cheapest({"weak": weak}, executor=here, mesh=rt.Mesh(10))
    with pytest.raises(rt.InputError, match="by name"):
        rt.applications.cheapest({})
