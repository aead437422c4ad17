"""Inequalities of few entries are eliminated, those of many are rows of the matrix: both hold at the optimum."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt

MOTORS = [f"u{i}" for i in range(14)]


def push(least: float) -> rt.Phase:
    """A block with 14 motors: the sum of two and the sum of all are limited, and so is their effort."""
    block = rt.System(["x", "v"], MOTORS, lambda p: [p.x["v"], sum(p.u[name] for name in MOTORS)])
    rows = [
        rt.PathConstraint(lambda p: p.u["u0"] + p.u["u1"], lower=least, name="two motors"),
        rt.PathConstraint(lambda p: sum(p.u[name] for name in MOTORS), upper=4.5, name="all motors"),
        rt.constraints.IntegralConstraint(lambda p: ca.sumsqr(ca.vertcat(*(p.u[name] for name in MOTORS))), upper=50),
    ]
    effort = rt.Lagrange(lambda p: sum((1 + i) * p.u[name] ** 2 for i, name in enumerate(MOTORS)))
    start, end = rt.State([0, 0]), rt.State([1, 0])
    return rt.Phase(block, 1.0, start, end, effort, constraints=rows)


@pytest.mark.parametrize("least", [0.0, 0.4])
def test_few_and_many_entries_have_the_optimum_of_ipopt(least: float) -> None:
    ours, other = (rt.plan(push(least), mesh=rt.Mesh(10), solver=solver) for solver in (rt.InteriorPoint(), rt.Ipopt()))
    assert ours.success and other.success
    np.testing.assert_allclose(ours.objective, other.objective, rtol=1e-6)
    controls = ours.at(np.linspace(0, 1, 21)).u
    motors = np.array([controls[name] for name in MOTORS])
    assert motors.sum(axis=0).max() > 4.5 - 1e-3
    assert motors[:2].sum(axis=0).min() < least + 1e-3
