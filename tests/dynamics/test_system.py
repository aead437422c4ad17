"""Systems: semi-explicit DAEs, in every form in which a user may write the equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.system import SystemDynamics
from robotraj.problem.constraints.base import symbols_of


@pytest.mark.parametrize(
    "write",
    [
        lambda v, u: [v, u],
        lambda v, u: (v, u),
        lambda v, u: ca.vertcat(v, u),
        lambda v, u: ca.horzcat(v, u),
        lambda v, u: np.array([v, u]),
        lambda v, u: [ca.vertcat(v, u)],
        lambda v, u: [[v], [u]],
    ],
    ids=["list", "tuple", "column", "row", "NumPy", "column in a list", "nested"],
)
def test_rates_may_be_any_sequence_of_scalars(write: Callable[[Any, Any], Any]) -> None:
    system = rt.System(["x", "v"], ["u"], lambda point: write(point.x["v"], point.u["u"]))
    dae = SystemDynamics(system)
    point = symbols_of(dae, ())
    rates = ca.Function("f", [point.x["v"], point.u["u"]], [dae.rates(point)])
    np.testing.assert_array_equal(rates(2, 3).full(), [[2], [3]])


def test_a_constant_rate_needs_no_symbols() -> None:
    clock = rt.System(["s"], [], lambda point: [1.0])
    solution = rt.plan(rt.Phase(clock, (0.1, 9), rt.State([0]), rt.State([4]), rt.Duration()), rt.Mesh(2))
    assert solution.duration == pytest.approx(4.0, abs=1e-7)


def test_a_single_rate_needs_no_list() -> None:
    decay = rt.System(["x"], [], lambda point: -point.x["x"])
    solution = rt.plan(rt.Phase(decay, 1.0, rt.State([1])), rt.Mesh(4, rt.schemes.GaussLegendre(points=5)))
    assert solution.at(1.0).x["x"] == pytest.approx(np.exp(-1), abs=1e-12)


def test_an_algebraic_variable_meets_its_equation_at_every_collocation_point() -> None:
    system = rt.System(
        ["x"],
        ["u"],
        lambda point: [point.z["flow"]],
        algebraic=["flow"],
        residual=lambda point: [point.z["flow"] ** 3 + point.z["flow"] - point.u["u"] + point.x["x"]],
    )
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2)
    solution = rt.plan(rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), cost), rt.Mesh(5))
    sample = solution.at(solution.phases[0].points)
    residual = sample.z["flow"] ** 3 + sample.z["flow"] - sample.u["u"] + sample.x["x"]
    np.testing.assert_allclose(residual, 0, atol=1e-7)


def test_eliminating_an_algebraic_variable_does_not_change_the_optimum() -> None:
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2)
    explicit = rt.System(["q", "w"], ["u"], lambda point: [point.x["w"], point.u["u"] - ca.sin(point.x["q"])])
    implicit = rt.System(
        ["q", "w"],
        ["u"],
        lambda point: [point.x["w"], point.z["a"]],
        algebraic=["a"],
        residual=lambda point: [point.z["a"] - point.u["u"] + ca.sin(point.x["q"])],
    )
    found = [
        rt.plan(rt.Phase(system, 2.5, rt.State([0, 0]), rt.State([np.pi, 0]), cost), rt.Mesh(15)).objective
        for system in (explicit, implicit)
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-8)


def test_names_and_units_are_those_given() -> None:
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]], units={"u": "m/s"}, name="cart")
    assert [(v.name, v.unit, v.label) for v in system.states + system.controls] == [
        ("x", "", "x"),
        ("u", "m/s", "u"),
    ]
    assert system.name == "cart"
