"""What a mesh is judged by, on polynomials whose coefficients are known."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.assess import assess
from robotraj.transcription.refinement.base import Assessment

MESH = rt.Mesh(3, rt.schemes.RadauIIA(3))
BREAKS = np.array([0.0, 1.0, 2.0, 3.0])
SITES = np.array([0.0, 0.3, 0.7, 1.0])


def seen(state: object, control: object, mesh: rt.Mesh = MESH) -> Assessment:
    """Assess a state and a control, functions of the place in an interval, in three intervals."""
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    phase = rt.Phase(system, 3.0, objective=rt.Lagrange(lambda point: point.u["u"] ** 2))
    x = PiecewisePolynomial(BREAKS, [SITES] * 3, [np.array(state(SITES))[:, None]] * 3)
    ends = np.array([0.0, 1.0])
    u = PiecewisePolynomial(BREAKS, [ends] * 3, [np.array(control(k, ends))[:, None] for k in range(3)])
    none = PiecewisePolynomial(BREAKS, [SITES] * 3, [np.empty((4, 0))] * 3)
    return assess(phase, PhaseTrajectory(0.0, 3.0, x, none, u, BREAKS, {}), mesh, True)


@pytest.mark.parametrize(
    ("coefficients", "decay"),
    [
        ([0.0, 1.0, 1e-2, 1e-4], 2.0),
        ([5.0, 1.0, 1e-1, 1e-2], 1.0),
        ([0.0, 1.0, 0.0, 0.0], 7.0),  # what a line lacks counts as 1e-14 of it
        ([1.0, 0.0, 0.0, 0.0], np.inf),  # a state at rest is not judged
    ],
)
def test_decay_is_the_slope_of_the_legendre_coefficients(coefficients: list[float], decay: float) -> None:
    found = seen(lambda s: np.polynomial.legendre.legval(2 * s - 1, coefficients), lambda k, s: 0.0 * s)
    np.testing.assert_allclose(found.decays, decay, rtol=1e-5)


@pytest.mark.parametrize("unit", [1e-12, 1e6])
def test_a_decay_is_the_same_in_any_unit(unit: float) -> None:
    found = seen(lambda s: unit * np.polynomial.legendre.legval(2 * s - 1, [0.0, 1.0, 0.1, 0.01]), lambda k, s: 0.0 * s)
    np.testing.assert_allclose(found.decays, 1.0, rtol=1e-5)


def test_a_jump_is_a_share_of_the_controls_range() -> None:
    """u falls by 1 in the first interval, by 1 before the second, by 2 before the third; its range is 4."""
    levels = [[4.0, 3.0], [2.0, 2.0], [0.0, 0.0]]
    found = seen(lambda s: s, lambda k, s: levels[k])
    np.testing.assert_allclose(found.jumps, [0.25, 0.5, 0.5])
    np.testing.assert_allclose(seen(lambda s: s, lambda k, s: 1.0 + 0.0 * s).jumps, 0.0)


def test_on_knots_that_move_only_what_lies_inside_is_a_jump() -> None:
    levels = [[4.0, 3.0], [2.0, 2.0], [0.0, 0.0]]
    moving = rt.schemes.MovingMesh(3, rt.schemes.RadauIIA(3, control=rt.schemes.ConstantControl()))
    found = seen(lambda s: s, lambda k, s: levels[k], moving)
    np.testing.assert_allclose(found.jumps, [0.25, 0.0, 0.0])
    np.testing.assert_array_equal(found.coarse, 0.0)


def test_a_kink_counts_by_how_far_the_neighbours_line_misses() -> None:
    """Lines of slope 1, 1 and -1, range 2: across the kink each misses the other's middle by 1, half of it."""
    lines = [[0.0, 1.0], [1.0, 2.0], [2.0, 1.0]]
    found = seen(lambda s: s, lambda k, s: lines[k])
    np.testing.assert_allclose(found.coarse, [0.0, 0.25, 0.25], atol=1e-15)
