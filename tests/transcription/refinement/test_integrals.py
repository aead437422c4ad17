"""Integral constraints count in the error of a mesh."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad

import robotraj as rt
from robotraj.transcription.refinement.assess import errors_of
from robotraj.transcription.refinement.error import interval_errors
from robotraj.transcription.refinement.integrals import integral_errors

LENGTH = 4.0


def length(point: Any) -> Any:
    return ca.sqrt(1 + point.u["slope"] ** 2)


def rope(objective: Any = None) -> rt.Phase:
    """A curve of a given length: the rates are exact whatever the slope, the length is not."""
    system = rt.System(["y"], ["slope"], lambda point: [point.u["slope"]])
    held = rt.constraints.IntegralConstraint(length, LENGTH, LENGTH, name="length")
    return rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), objective, [held])


@pytest.mark.parametrize(
    "scheme",
    [rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(2), rt.schemes.Trapezoidal()],
    ids=str,
)
def test_the_error_is_what_the_quadrature_leaves(scheme: rt.schemes.Collocation) -> None:
    solution = rt.plan(rope(), rt.Mesh(6, scheme), check=False)
    part = solution.phases[0]
    errors = integral_errors(part.phase, part.trajectory, part.mesh.schemes)
    u, breaks = part.trajectory.u, part.trajectory.x.breaks
    for k, (a, b) in enumerate(zip(breaks[:-1], breaks[1:], strict=True)):
        own = (b - a) * scheme.objective_weights @ np.sqrt(1 + u(a + (b - a) * scheme.nodes, k)[:, 0] ** 2)
        whole = quad(lambda t, k=k: np.sqrt(1 + u(np.array([t]), k)[0, 0] ** 2), a, b, epsabs=1e-12)[0]
        # The finer rule is one of polynomials too.
        assert errors[k] / len(errors) == pytest.approx(abs(own - whole) / (1 + LENGTH), rel=0.1, abs=1e-9)
    assert interval_errors(part.phase, part.trajectory).max() < 1e-9 < errors.max()
    np.testing.assert_array_equal(errors_of(part.phase, part.trajectory, part.mesh).max(), solution.error)


def test_a_plan_to_a_tolerance_keeps_the_integral_itself() -> None:
    solution = rt.plan(rope(), tolerance=1e-6)
    assert rt.validate(solution).passed
    u, knots = solution.phases[0].trajectory.u, solution.phases[0].knots
    pieces = zip(knots[:-1], knots[1:], strict=True)
    points, weights = np.polynomial.legendre.leggauss(20)
    found = sum(
        0.5 * (b - a) * weights @ np.sqrt(1 + u(a + 0.5 * (b - a) * (points + 1), k)[:, 0] ** 2)
        for k, (a, b) in enumerate(pieces)
    )
    assert found == pytest.approx(LENGTH, abs=1e-4)


def test_phases_without_integral_constraints_have_none() -> None:
    part = rt.plan(rope().with_(constraints=())).phases[0]
    assert not integral_errors(part.phase, part.trajectory, part.mesh.schemes).any()
