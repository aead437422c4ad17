"""An optimum of zero is proved: its errors are relative to what a motion costs that is one size away."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.claims.objective_size import SHARE, objective_size

MASS = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], units={"x": "m", "v": "m/s", "u": "N"})
EFFORT = rt.Lagrange(lambda p: p.u["u"] ** 2)


def coasting() -> rt.Phase:
    return rt.Phase(MASS, 1.0, rt.State([0.0, 1.0]), rt.State([1.0, None]), EFFORT)


def following() -> rt.Phase:
    return rt.Phase(MASS, 3.0, rt.State([0, 0]), None, rt.Lagrange(lambda p: (p.x["x"] - 1 + ca.cos(p.t)) ** 2))


def cancelling() -> rt.Phase:
    """Half of the work gained is spent: min u^2 - x(T) over 3 s is -9/4, and 9/4 is added."""
    gained = rt.Mayer(lambda _, end: 2.25 - end.x["x"])
    return rt.Phase(MASS, 3.0, rt.State([0, 0]), None, EFFORT + gained)


def hanging() -> rt.Phase:
    rest = rt.State(q=[0.0], v=[0.0])
    return rt.Phase(rt.load("pendulum"), 1.0, rest, rest, rt.Effort())


@pytest.mark.parametrize("make", [coasting, following, cancelling, hanging])
def test_an_optimum_of_zero_is_proved(make: Callable[[], rt.Phase]) -> None:
    solution = rt.plan(make(), progress=False)
    assert solution.proof is not None and solution.proof.holds
    assert abs(solution.objective) < 1e-5
    assert rt.validate(solution).passed


def test_the_size_of_an_optimum_of_zero_is_a_share_of_the_cost_one_size_away() -> None:
    """The coasting mass moves 1 m in 1 s, so that 1 N moves its speed by its size."""
    plan = rt.plan(coasting(), progress=False)
    assert objective_size(plan.phases, plan.objective) == pytest.approx(SHARE, rel=1e-3)


def test_any_other_objective_is_its_own_size() -> None:
    plan = rt.plan(rt.Phase(MASS, 1.0, rt.State([0, 0]), rt.State([1e-6, 0]), EFFORT), progress=False)
    assert objective_size(plan.phases, plan.objective) == plan.objective == pytest.approx(12e-12, rel=1e-3)


@pytest.mark.parametrize("size", [1e-6, 1e-3])
def test_the_size_follows_the_unit_of_the_states(size: float) -> None:
    def cost(p: rt.SystemPoint) -> ca.SX:
        return (p.x["x"] / size - 1 + ca.cos(p.t)) ** 2

    scaled = rt.Phase(MASS, 3.0, rt.State([0, 0]), None, rt.Lagrange(cost))
    sizes = [
        objective_size(plan.phases, 0.0) for plan in (rt.plan(each, progress=False) for each in (scaled, following()))
    ]
    assert np.ptp(sizes) < 1e-3 * max(sizes)
