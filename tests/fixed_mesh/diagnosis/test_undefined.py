"""NaN is traced to its expression, its operation and its point."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import pytest

import robotraj as rt


def block(**more: Any) -> rt.Phase:
    dynamics = more.pop("dynamics", lambda point: [point.x["v"], point.u["u"]])
    fields = {"objective": rt.Duration(), "controls": {"u": rt.between(-1, 1)}}
    system = rt.System(["x", "v"], ["u"], dynamics, name="block")
    return rt.Phase(system, (0.1, 20.0), rt.State([0, 0]), rt.State([1, 0]), **(fields | more))


def row(expression: Callable[[Any], Any]) -> list[rt.PathConstraint]:
    return [rt.PathConstraint(expression, upper=1.0, name="height")]


CASES = {
    "integrand": (
        lambda: block(objective=rt.Lagrange(lambda p: ca.sqrt(p.x["x"] - 0.5))),
        ["objective term Lagrange", "sqrt(-0.5)", "t = 0 s, where x = 0"],
    ),
    "end cost": (
        lambda: block(objective=rt.Mayer(lambda a, b: ca.log(a.x["x"] - b.x["x"]))),
        ["objective term Mayer", "log(-0.9", "at the ends"],
    ),
    "row": (
        lambda: block(constraints=row(lambda p: ca.log(p.x["x"] + 0.1 * p.u["u"]))),
        ["row 'height'", "log(0)", "where x = 0, u = 0"],
    ),
    "equation": (
        lambda: block(dynamics=lambda p: [p.x["v"], p.u["u"] / p.x["x"]]),
        ["rate of 'v'", "0 / 0", "t = 0 s"],
    ),
    "derivative": (
        lambda: block(objective=rt.Lagrange(lambda p: ca.sqrt(p.x["v"] ** 2 + p.u["u"] ** 2))),
        ["derivative of the objective term Lagrange", "t = 0 s"],
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_cause_names_the_expression_and_the_point(case: str) -> None:
    build, words = CASES[case]
    with pytest.raises(rt.NoSolutionFound) as caught:
        rt.plan(build(), guess=rt.guess.StraightLine(duration=1.0))
    first = str(caught.value).partition("\n")[0]
    assert all(word in first for word in words), first
    assert caught.value.solution.status is rt.solvers.Status.INVALID_NUMBER
