"""Values that users' functions return, and NaN from Python's math functions of symbols."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.dynamics.expression_values import as_rows, rows_of


def phase(**changes: Any) -> rt.Phase:
    def rates(point: Any) -> list[ca.SX]:
        return [point.x["w"], point.u["m"] - ca.sin(point.x["q"])]

    system = rt.System(["q", "w"], ["m"], changes.pop("rates", rates))
    given: dict[str, Any] = {"objective": rt.Lagrange(lambda point: point.u["m"] ** 2)}
    return rt.Phase(system, 2.0, rt.State([0, 0]), rt.State([1, 0]), **{**given, **changes})


def sine(point: Any) -> float:
    return math.sin(point.x["q"])


@pytest.mark.parametrize(
    "values",
    [
        1.0,
        np.float64(2),
        np.int64(3),
        [1.0, 2.0],
        np.eye(2),
        ca.DM([1, 2]),
        ca.SX.sym("x", 2, 2),
        [ca.SX.sym("x"), [1.0, np.ones(2)]],
    ],
)
def test_scalars_lists_and_matrices_become_rows(values: Any) -> None:
    assert all(row.numel() == 1 for row in as_rows(values, "rows"))


@pytest.mark.parametrize(
    "values",
    [
        np.complex128(1 + 1j),
        1 + 1j,
        np.array([1j]),
        "x",
        np.str_("1"),
        None,
        {},
        (x for x in [1.0]),
        {1.0},
        ca.MX.sym("x"),
    ],
)
def test_what_is_no_number_is_refused(values: Any) -> None:
    with pytest.raises(InputError, match="^The rows must return numbers or CasADi SX expressions of the point, got"):
        rows_of("rows", lambda: values)


@pytest.mark.parametrize(
    ("function", "row"),
    [
        (lambda x: math.sin(x), ""),
        (lambda x: [x, x * math.cos(x)], " in row 1"),
        (lambda x: [x, ca.sqrt(-x) + math.exp(x)], " in row 1"),
        (lambda x: ca.vertcat(float("nan"), x), " in row 0"),
    ],
)
def test_nan_among_an_expressions_numbers_is_refused(function: Callable[[ca.SX], Any], row: str) -> None:
    with pytest.raises(InputError, match=f"^The expression is NaN{row} at every point: .* casadi.sin"):
        rows_of("expression", function, ca.SX.sym("x"))


def test_roots_and_logarithms_that_have_no_value_somewhere_are_not() -> None:
    x = ca.SX.sym("x")
    rows = rows_of("expression", lambda x: [ca.sqrt(-x), ca.log(-1 - x), 1 / (x - 0.7), ca.acos(3 * x)], x)
    assert len(rows) == 4


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: phase(rates=lambda point: [point.x["w"], point.u["m"] - math.sin(point.x["q"])]), "dynamics of"),
        (lambda: phase(objective=rt.Lagrange(sine)), "Lagrange expression"),
        (lambda: phase(objective=rt.Mayer(lambda start, end: math.sin(end.x["q"]))), "Mayer expression"),
        (
            lambda: phase(constraints=[rt.PathConstraint(sine, upper=1.0, name="wall")]),
            "expression of constraint 'wall'",
        ),
    ],
)
def test_a_plan_names_the_function_that_returns_nan(make: Callable[[], rt.Phase], named: str) -> None:
    with pytest.raises(InputError, match=f"{named}.* NaN"):
        rt.plan(make(), rt.Mesh(4))
