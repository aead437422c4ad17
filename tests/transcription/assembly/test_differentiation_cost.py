"""The cost of differentiating a point function."""

from __future__ import annotations

import casadi as ca
import pytest

import robotraj as rt
from robotraj._util.time_left import LimitReached, is_limited, limited
from robotraj.fixed_mesh.plan_limits import PlanLimits
from robotraj.transcription.assembly.differentiation_cost import EVALUATIONS, JACOBIAN, operations


def square() -> ca.Function:
    x = ca.SX.sym("x")
    return ca.Function("square", [x], [x * x + ca.sin(x)])


def test_operations_of_called_functions_count_once_a_call() -> None:
    x, inner = ca.MX.sym("x"), square()
    assert operations(inner) == inner.n_instructions()
    twice = ca.Function("twice", [x], [inner(inner(x))])
    assert operations(twice) == twice.n_instructions() + 2 * operations(inner)
    nested = ca.Function("nested", [x], [twice(x) + inner(x)])
    # CasADi writes the calls of a graph of calls out.
    assert operations(nested) == nested.n_instructions() + 3 * operations(inner)


def test_an_integrator_evaluates_its_equations_many_times() -> None:
    x = ca.SX.sym("x")
    flow = ca.integrator("flow", "cvodes", {"x": x, "ode": -x * x})
    assert operations(flow) == EVALUATIONS * operations(flow.oracle())


def test_a_table_is_one_operation() -> None:
    assert operations(ca.interpolant("table", "linear", [[0.0, 1.0, 2.0]], [0.0, 1.0, 4.0])) == 1


def test_the_cost_is_announced_to_the_limits_of_the_plan() -> None:
    JACOBIAN.announce(10**9, 1000)
    assert not is_limited()
    with limited(PlanLimits(100.0, float("inf"), None)):
        assert is_limited()
        JACOBIAN.announce(10**6, 10)
        with pytest.raises(LimitReached, match="100 s"):
            JACOBIAN.announce(10**6, 1000)


def test_single_shooting_differentiates_few_directions_at_a_time() -> None:
    """With CasADi's 64 the functions of a ur5 took 2 GB."""
    scheme = rt.schemes.SingleShooting().over([0.0, 0.5, 1.0])
    x, c, q = ca.SX.sym("x", 2), ca.SX.sym("c"), ca.SX.sym("q", 6)
    rate = ca.Function("rate", [c, x, q], [ca.vertcat(x[1], -ca.sin(x[0]) + q[0])])
    step = scheme.step(rate)
    v = ca.MX.sym("v", 200)
    y = step(v[:2], v[2:4], v[4:10])[0] + sum(step(v[k : k + 2], v[:2], v[2:8])[0] for k in range(10, 190, 6))
    jacobian = ca.Function("jacobian", [v], [ca.jacobian(y, v)])
    calls = [
        jacobian.instruction_MX(k).which_function()
        for k in range(jacobian.n_instructions())
        if jacobian.instruction_id(k) == ca.OP_CALL
    ]
    assert calls and all(each.size2_out(0) <= 4 for each in calls)
