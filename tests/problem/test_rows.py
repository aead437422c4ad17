"""The table of rows of a phase: kinds, expressions and values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.constraints.base import Where, symbols_of
from robotraj.problem.phase_row import Kind, PhaseRow


def block(**options: Any) -> rt.Phase:
    dynamics = rt.System(
        states=["x", "v"],
        controls=["u"],
        algebraic=["lam"],
        dynamics=lambda point: [point.x["v"], point.u["u"]],
        residual=lambda point: [point.z["lam"] - point.x["x"] * point.u["u"]],
    )
    return rt.Phase(dynamics, 1.0, **options)


def test_each_row_has_the_kind_by_which_it_is_imposed() -> None:
    phase = block(
        states={"v": rt.between(-3, 3)},
        controls={"u": rt.between(-1, 1)},
        constraints=[
            rt.PathConstraint(lambda p: [p.x["x"] ** 2, p.x["v"] * p.u["u"]], upper=[1, 2], name="path"),
            rt.constraints.IntegralConstraint(lambda p: p.u["u"] ** 2, upper=5, name="energy"),
            rt.constraints.AtEnd(rt.PathConstraint(lambda p: p.x["x"] + p.x["v"], 0, 0, name="sum")),
        ],
    )
    table = phase.rows
    assert [(row.name, row.kind, row.where) for row in table] == [
        ("state bound", Kind.BOUND, Where.THROUGHOUT),
        ("control bound", Kind.BOUND, Where.THROUGHOUT),
        ("path[0]", Kind.PATH, Where.THROUGHOUT),
        ("path[1]", Kind.PATH, Where.THROUGHOUT),
        ("energy", Kind.INTEGRAL, Where.INTEGRAL),
        ("sum", Kind.END, Where.END),
    ]
    assert [row.number for row in table] == list(range(6))
    assert [(row.constraint, row.entry) for row in table] == [(0, 0), (1, 0), (2, 0), (2, 1), (3, 0), (4, 0)]
    numbers = {
        name: [row.number for row in getattr(table, name)]
        for name in ("bounds", "path", "integrals", "throughout", "of_state", "of_inputs")
    }
    assert numbers == {
        "bounds": [0, 1],
        "path": [2, 3],
        "integrals": [4],
        "throughout": [0, 1, 2, 3],
        "of_state": [0, 2],
        "of_inputs": [3],
    }
    assert [row.number for row in table.at(Where.END)] == [5] and not table.at(Where.START)
    assert table.rows[5].is_equality and not table.rows[3].is_equality
    assert [row.greatest_bound for row in table] == [3, 1, 1, 2, 5, 0]


@pytest.mark.parametrize(
    ("bounds", "size"),
    [
        ((-100.0, 100.0), 100.0),
        ((0.0, np.inf), 1.0),
        ((-np.inf, 50.0), 50.0),
        ((0.04, np.inf), 0.04),
        ((1e-6, np.inf), 0.01),
        ((3.0, 3.0), 3.0),
        ((0.1, 0.1), 1.0),
    ],
)
def test_a_row_is_measured_by_half_its_range_or_its_bound(bounds: tuple[float, float], size: float) -> None:
    assert PhaseRow("torque", "N m", *bounds).size == size


@pytest.mark.parametrize("change", [1e-9, 1e-3])
@pytest.mark.parametrize(("lower", "upper"), [(-np.inf, 0.0), (0.0, 0.0), (3.0, np.inf), (-1e9, 0.0), (-2.0, 2.0)])
def test_a_row_is_measured_by_a_few_times_what_a_motion_changes_it_by(
    change: float, lower: float, upper: float
) -> None:
    """A bound of 0, a unit and a number far away on the other side do not measure a small motion."""
    assert PhaseRow("any", "", lower, upper).size_in(change) == pytest.approx(3.0 * change)


def test_a_range_smaller_than_the_motion_is_the_size_of_its_row() -> None:
    assert PhaseRow("any", "", -0.1, 0.1).size_in(7.0) == pytest.approx(0.1)


@pytest.mark.parametrize("change", [0.0, np.nan, np.inf])
def test_a_row_that_no_motion_changes_has_its_size_without_one(change: float) -> None:
    assert PhaseRow("any", "", -np.inf, 0.0).size_in(change) == PhaseRow("any", "", -np.inf, 0.0).size == 1.0


def test_rows_that_depend_on_algebraic_variables_are_no_rows_of_the_state() -> None:
    (row,) = (table := block(constraints=[rt.PathConstraint(lambda p: p.z["lam"], upper=1)]).rows)
    assert not table.of_state and table.of_inputs == (row,)


def test_by_forward_dynamics_accelerations_are_expressions_of_torques() -> None:
    """A row of accelerations depends on controls although they are no variables."""
    robot = rt.load("cartpole")
    phase = rt.Phase(
        robot,
        1.0,
        constraints=[rt.PathConstraint(lambda p: p.a[0], upper=9.0), rt.PathConstraint(lambda p: p.v[1], upper=9.0)],
        limits=None,
        dynamics=rt.dynamics.ForwardDynamics(),
    )
    acceleration, velocity = phase.rows
    assert phase.rows.of_state == (velocity,) and phase.rows.of_inputs == (acceleration,)


def test_values_are_the_expressions_at_times() -> None:
    phase = block(
        states={"v": rt.between(-3, 3)},
        constraints=[rt.PathConstraint(lambda p: [p.t * p.x["x"], p.z["lam"] + p.u["u"] * p.p["mass"]], upper=[1, 2])],
        parameters={"mass": 2.0},
    )
    table, rng = phase.rows, np.random.default_rng(0)
    t, x, z, u = rng.normal(size=5), rng.normal(size=(5, 2)), rng.normal(size=(5, 1)), rng.normal(size=(5, 1))
    expected = np.column_stack([z[:, 0] + 2.0 * u[:, 0], x[:, 1], t * x[:, 0]])
    rows = (table.rows[2], table.rows[0], table.rows[1])
    assert table.sample(rows, t, x, z, u, np.array([2.0])) == pytest.approx(expected, abs=1e-15)

    point = symbols_of(phase.dae, phase.parameter_names)
    symbols = [point.t, point.x.column, point.z.column, point.u.column, point.p.column]
    function = ca.Function("rows", symbols, [table.column(rows, point)])
    assert np.array(function(t[0], x[0], z[0], u[0], 2.0)).ravel() == pytest.approx(expected[0], abs=1e-15)
    assert table.column((), point).shape == (0, 1)


def test_each_constraint_is_evaluated_once_for_all_who_read_it() -> None:
    calls = []

    def expression(point: Any) -> list[Any]:
        calls.append(point)
        return [point.x["x"], point.x["v"]]

    table = block(constraints=[rt.PathConstraint(expression, upper=[1, 2])]).rows
    before = len(calls)
    first, second = table.rows
    assert table.of_state == (first, second)
    assert table.function((second,)) is table.function((second,))
    _ = table.function((first, second)), table.expressions((first,))
    assert len(calls) == before + 1
    _ = table.values((first, second), symbols_of(table.dae, table.parameters))
    assert len(calls) == before + 2


def test_limits_are_the_tightest_bounds_of_a_variable() -> None:
    phase = rt.Phase(
        rt.load("cartpole"),
        1.0,
        constraints=[
            rt.constraints.JointVelocity({"slider": rt.between(-2.0, 2.0)}),
            rt.constraints.AtEnd(rt.constraints.JointVelocity({"slider": rt.between(-1.0, 1.0)})),
        ],
    )
    table = phase.rows
    assert table.limits()["v.slider"] == (-2.0, 2.0)
    assert table.limits(Where.END)["v.slider"] == (-1.0, 1.0)
    bounds = table.bounds_of(phase.dae.states)
    assert [phase.dae.states[i].name for _, i in bounds] == [row.variable for row, _ in bounds]
    assert all(row.where is Where.THROUGHOUT for row, _ in bounds)
    assert not {row.variable for row, _ in bounds} & {control.name for control in phase.dae.controls}


def test_rows_are_found_by_the_constraint_that_the_phase_was_given() -> None:
    make: Callable[[float], rt.PathConstraint] = lambda bound: rt.PathConstraint(lambda p: p.x["x"], upper=bound)  # noqa: E731
    one, two = make(1.0), make(1.0)
    table = block(constraints=[one, two], states={"v": rt.between(-3, 3)}).rows
    assert [row.number for row in table.of(one)] == [1] and [row.number for row in table.of(two)] == [2]


def test_phases_that_differ_in_their_ends_alone_share_a_table() -> None:
    phase = block(constraints=[rt.PathConstraint(lambda p: p.x["x"], upper=2.0)])
    assert phase.with_(end=rt.State({"x": 1.0})).rows is phase.rows
    assert phase.with_(constraints=[]).rows is not phase.rows


def test_an_expression_of_another_length_than_its_rows_is_refused() -> None:
    table = block(constraints=[rt.PathConstraint(lambda p: [p.x["x"], p.x["v"]], upper=1, name="pair")]).rows
    (pair,) = table.constraints
    shorter = replace(table, constraints=(replace(pair, rows=pair.rows[:1]),))
    with pytest.raises(rt.InputError, match="'pair' returns 2 values for its 1 rows"):
        shorter.values(shorter.rows, table.point)
