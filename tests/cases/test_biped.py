"""Kelly's biped on the meshes of an independent implementation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from problems.biped import FLIP, RATE, Q, biped

import robotraj as rt
from robotraj.solvers.ipopt import Ipopt

MESHES = [
    (False, "trap", 9, 494.713063),
    (False, "trap", 24, 473.864866),
    (False, "trap", 44, 470.983706),
    (False, "hs", 6, 469.547244),
    (False, "hs", 15, 469.643326),
    (False, "hs", 25, 469.646777),
    (False, "hs", 40, 469.648825),
    (True, "trap", 9, 407.275652),
    (True, "trap", 24, 393.497322),
    (True, "trap", 44, 391.638920),
    (True, "hs", 6, 390.766557),
    (True, "hs", 15, 390.789836),
    (True, "hs", 25, 390.790437),
]
SCHEMES = {"trap": rt.schemes.Trapezoidal(), "hs": rt.HermiteSimpson()}


@pytest.mark.parametrize(("from_hip", "scheme", "intervals", "value"), MESHES)
def test_optimum_on_a_mesh_is_that_of_an_independent_implementation(
    from_hip: bool, scheme: str, intervals: int, value: float
) -> None:
    """Rows hold at the collocation points alone, as in the reference: nothing is imposed between them."""
    case = biped(from_hip)
    solution = rt.plan(
        case.problem,
        rt.Mesh(intervals, SCHEMES[scheme]),
        case.guess,
        Ipopt(),
        interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0),
    )
    assert solution.success
    assert solution.objective == pytest.approx(value, abs=2e-6)


def test_the_step_is_the_published_one() -> None:
    case = biped(torso_from_hip=False)
    solution = rt.plan(case.problem, rt.Mesh(40), case.guess)
    first, last = solution.at(0.0).x, solution.at(0.7).x
    pose = [first[name] for name in Q]
    np.testing.assert_allclose(pose, [0.08653, 0.49315, -0.12741, -0.34671, -0.35797], atol=2e-4)
    np.testing.assert_allclose([first[n] for n in RATE], [-1.5065, -0.6053, 0.0153, -0.5454, -2.0144], atol=2e-3)
    np.testing.assert_allclose([last[n] for n in RATE], [-2.1747, -1.6220, 1.0270, -1.3786, 2.9906], atol=2e-3)
    np.testing.assert_allclose(pose, np.array([last[name] for name in Q])[FLIP], atol=1e-9)
    heights = [foot_height(solution.at(t).x) for t in np.linspace(0, 0.7, 701)]
    assert min(heights) == pytest.approx(0, abs=1e-4)
    assert max(heights) == pytest.approx(0.07121, abs=1e-4)


def foot_height(x: Mapping[str, float]) -> float:
    q = [x[name] for name in Q]
    return float(0.4 * (np.cos(q[0]) + np.cos(q[1]) - np.cos(q[3]) - np.cos(q[4])))


@pytest.mark.slow
def test_the_witness_follows_the_step() -> None:
    case = biped(torso_from_hip=False)
    solution = rt.plan(case.problem, guess=case.guess, tolerance=1e-6)
    rt.validate(solution).check(drift=1e-6, limits=1e-5)
