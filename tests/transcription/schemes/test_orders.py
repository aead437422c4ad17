"""Orders of convergence, measured on a smooth optimal control problem with a closed form.

With y = exp(x), the problem  min int_0^1 y^2 + u^2 dt,  y' = u,  y(0) = 1  has y = cosh(1 - t) / cosh(1)
and the cost tanh(1). Written in x it is nonlinear: x' = u exp(-x).
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.schemes.collocation import Collocation

SYSTEM = rt.System(["x"], ["u"], lambda point: [point.u["u"] * ca.exp(-point.x["x"])])
PHASE = rt.Phase(
    SYSTEM,
    duration=1.0,
    start=rt.State({"x": 0.0}),
    objective=rt.Lagrange(lambda point: ca.exp(2 * point.x["x"]) + point.u["u"] ** 2),
)
LECTURE = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
ROUND_OFF = 2e-13


def errors(scheme: Collocation, intervals: int) -> tuple[float, float]:
    """Errors of the last state and of the cost."""
    solution = rt.plan(PHASE, rt.Mesh(intervals, scheme), solver=rt.Ipopt(tolerance=1e-12))
    last = solution.at(1.0).x["x"]
    return abs(last + np.log(np.cosh(1.0))), abs(solution.objective - np.tanh(1.0))


@pytest.mark.parametrize(
    ("scheme", "order", "meshes"),
    [
        (rt.schemes.Trapezoidal(), 2, (16, 32, 64)),
        (rt.HermiteSimpson(), 4, (4, 8, 16)),
        (rt.schemes.LobattoIIIA(points=4), 6, (8, 16)),
        (rt.schemes.FifthDegree(), 8, (2, 4, 8)),
        (rt.schemes.RadauIIA(points=1), 1, (32, 64, 128)),
        (rt.schemes.RadauIIA(points=2), 3, (32, 64, 128)),
        (rt.schemes.RadauIIA(points=3), 5, (8, 16, 32)),
        (rt.schemes.RadauIIA(points=4), 7, (4, 8)),
        (rt.schemes.GaussLegendre(points=1), 2, (8, 16, 32)),
        (rt.schemes.GaussLegendre(points=2), 4, (4, 8, 16)),
        (rt.schemes.GaussLegendre(points=3), 6, (2, 4, 8)),
        (LECTURE, 2, (16, 32, 64)),
    ],
    ids=lambda value: f"{type(value).__name__}-{len(value.nodes)}" if isinstance(value, Collocation) else None,
)
def test_the_last_state_converges_with_the_order_of_the_scheme(
    scheme: Collocation, order: int, meshes: tuple[int, ...]
) -> None:
    found = np.array([errors(scheme, n)[0] for n in meshes])
    assert np.all(found > ROUND_OFF)
    slopes = np.log2(found[:-1] / found[1:])
    np.testing.assert_allclose(slopes, order, atol=0.3)


@pytest.mark.parametrize(
    ("scheme", "order", "meshes"),
    [
        (rt.schemes.Trapezoidal(), 2, (16, 32, 64)),
        (rt.HermiteSimpson(), 4, (4, 8, 16)),
        (rt.schemes.FifthDegree(), 8, (2, 4)),
        (LECTURE, 2, (16, 32, 64)),
    ],
    ids=["trapezoid", "Hermite-Simpson", "fifth-degree", "lecture"],
)
def test_the_cost_converges_with_the_order_of_the_scheme(
    scheme: Collocation, order: int, meshes: tuple[int, ...]
) -> None:
    found = np.array([errors(scheme, n)[1] for n in meshes])
    assert np.all(found > ROUND_OFF)
    slopes = np.log2(found[:-1] / found[1:])
    np.testing.assert_allclose(slopes, order, atol=0.3)


def test_more_points_in_one_interval_converge_to_round_off() -> None:
    assert max(errors(rt.schemes.GaussLegendre(points=9), 1)) < ROUND_OFF
