"""Bounds imposed on Bernstein coefficients of algebraic variables hold between the collocation points."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.between.nlp_violations import violations
from tests.transcription.interval_limits.test_bernstein_bounds import HULL, LOWER, SCHEMES, UPPER, planned


def accelerated() -> rt.Problem:
    """A block whose acceleration is an algebraic variable with limits, and whose force is not limited."""
    system = rt.System(
        ["x", "v"],
        ["u"],
        algebraic=["a"],
        dynamics=lambda point: [point.x["v"], point.z["a"]],
        residual=lambda point: [point.z["a"] - point.u["u"]],
    )
    ends = rt.State({"x": 0, "v": 0}), rt.State({"x": 3, "v": 0})
    limits = {"a": rt.between(LOWER, UPPER)}
    return rt.Problem([rt.Phase(system, (0.5, 20.0), *ends, rt.Duration(), algebraic=limits)])


def test_a_violation_names_its_algebraic_variable_and_time() -> None:
    nlp = rt.transcription.transcribe(accelerated(), rt.Mesh(4), rt.guess.StraightLine(4.0), interval_limits=HULL)
    w = nlp.guess.copy()
    for interval in nlp.layouts[0].intervals:
        w[interval.algebraic] = UPPER
    w[nlp.layouts[0].intervals[2].algebraic[1]] = UPPER + 0.1
    (found,) = (v for v in violations(nlp, w, 1e-6) if "a" in v.label.split(", "))
    assert (found.time, found.amount) == (pytest.approx(2.5), pytest.approx(0.2))


@pytest.mark.parametrize("scheme", ["Hermite-Simpson", "Radau 2", "Radau 4", "Gauss 2", "fifth degree"])
def test_algebraic_variables_keep_their_limits_everywhere(scheme: str) -> None:
    solution = planned(accelerated(), rt.Mesh(13, SCHEMES[scheme]), HULL)
    knots, rng = solution.phases[0].knots, np.random.default_rng(4)
    for k, (first, last) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        a = solution.phases[0].trajectory.z(rng.uniform(first, last, 100), k)[:, 0]
        assert a.min() > LOWER - 1e-6 and a.max() < UPPER + 1e-6
    # With accelerations b and -c the least time over a distance d is sqrt(2 d (1 / b + 1 / c)).
    assert solution.duration == pytest.approx(np.sqrt(2 * 3 * (1 / UPPER - 1 / LOWER)), rel=0.02)
