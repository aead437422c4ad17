"""Meshes: knots, and schemes that differ from interval to interval."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
MOVE = rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State([1, 0]), objective=rt.Lagrange(lambda point: point.u["u"] ** 2))
CLASSES = (
    rt.schemes.Trapezoidal,
    rt.HermiteSimpson,
    rt.schemes.FifthDegree,
    rt.schemes.RadauIIA,
    rt.schemes.GaussLegendre,
)


def test_a_number_gives_equal_intervals() -> None:
    np.testing.assert_allclose(rt.Mesh(4).knots, [0, 0.25, 0.5, 0.75, 1])
    assert rt.Mesh(4).count == 4


@pytest.mark.parametrize("count", [0, -1, 100_001, 10**400])
def test_a_mesh_has_one_to_a_hundred_thousand_intervals(count: int) -> None:
    for make in (rt.Mesh, rt.Mesh.chebyshev):
        with pytest.raises(rt.InputError, match="must be a whole number from 1 to 100000"):
            make(count)


def test_knots_may_be_given() -> None:
    mesh = rt.Mesh([0, 0.1, 1], [rt.schemes.Trapezoidal(), rt.HermiteSimpson()])
    assert mesh.count == 2
    assert mesh.schemes == (rt.schemes.Trapezoidal(), rt.HermiteSimpson())


def test_chebyshev_knots_crowd_at_both_ends_symmetrically() -> None:
    mesh = rt.Mesh.chebyshev(4, rt.schemes.RadauIIA(2))
    half = np.sqrt(0.5)
    np.testing.assert_allclose(mesh.knots, [0, (1 - half) / 2, 0.5, (1 + half) / 2, 1], atol=1e-15)
    assert mesh.schemes == (rt.schemes.RadauIIA(2),) * 4
    assert rt.Mesh.chebyshev(1) == rt.Mesh([0, 1])
    assert isinstance(rt.schemes.MovingMesh.chebyshev(3), rt.schemes.MovingMesh)
    for wrong in (0, 2.5, True):
        with pytest.raises(rt.InputError, match="whole number"):
            rt.Mesh.chebyshev(wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("first", CLASSES, ids=lambda c: c.__name__)
@pytest.mark.parametrize("second", CLASSES, ids=lambda c: c.__name__)
def test_any_scheme_may_follow_any_other(first: type, second: type) -> None:
    """The cost of the block's quadratic plan is 12; only the trapezoid misses it, by its known error."""
    fine = rt.Mesh([0, 0.3, 0.5, 0.6, 1], [first(), second(), first(), second()])
    solution = rt.plan(MOVE, fine)
    assert solution.success
    trapezoid = rt.schemes.Trapezoidal in (first, second)
    assert solution.objective == pytest.approx(12.0, rel=0.25 if trapezoid else 1e-9)


@pytest.mark.parametrize(
    "control", [rt.schemes.PolynomialControl(), rt.schemes.LinearControl(), rt.schemes.ConstantControl()]
)
@pytest.mark.parametrize("scheme", CLASSES, ids=lambda c: c.__name__)
def test_every_control_runs_with_every_scheme(scheme: type, control: object) -> None:
    solution = rt.plan(MOVE, rt.Mesh(20, scheme(control=control)))
    assert solution.success
    assert solution.objective == pytest.approx(12.0, rel=2e-2)
    u = solution.phases[0].trajectory.u
    inside = np.array([0.011, 0.021, 0.031, 0.041])
    steps = np.diff(u(inside)[:, 0])
    if isinstance(control, rt.schemes.ConstantControl):
        np.testing.assert_allclose(steps, 0, atol=1e-12)
    elif isinstance(control, rt.schemes.LinearControl):
        np.testing.assert_allclose(steps, steps[0], rtol=1e-6)
