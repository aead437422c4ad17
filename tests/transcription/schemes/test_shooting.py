"""Shooting: order of the integrators, interpolants that match them, sites of the controls."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.schemes.control import Control
from robotraj.transcription.schemes.integrators import Integrator

C, X, Q = ca.SX.sym("c"), ca.SX.sym("x", 2), ca.SX.sym("q")
RATE = ca.Function("rate", [C, X, Q], [ca.vertcat(X[1], -(Q**2) * X[0] + C)])


def exact(c: np.ndarray, q: float) -> np.ndarray:
    """Solution from (1, 0): x'' = -q^2 x + c."""
    position = np.cos(q * c) + c / q**2 - np.sin(q * c) / q**3
    speed = -q * np.sin(q * c) + (1 - np.cos(q * c)) / q**2
    return np.array([position, speed])


def error_at_the_end(integrator: Integrator, q: float = 3.0) -> float:
    end = np.array(integrator.flow(RATE)([1.0, 0.0], q)).ravel()
    return float(np.max(np.abs(end - exact(np.array(1.0), q))))


def test_runge_kutta_has_order_four() -> None:
    errors = np.array([error_at_the_end(rt.schemes.RungeKutta4(n)) for n in (8, 16, 32, 64)])
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 4, atol=0.2)


@pytest.mark.parametrize("stiff", [False, True])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_the_adaptive_integrator_keeps_its_tolerance(tolerance: float, stiff: bool) -> None:
    assert error_at_the_end(rt.schemes.Adaptive(tolerance, stiff)) < 100 * tolerance


def test_dense_output_of_runge_kutta_has_order_four_as_well() -> None:
    sites = np.linspace(0, 1, 23)
    errors = []
    for n in (4, 8, 16):
        found = np.array(rt.schemes.RungeKutta4(n).samples(RATE, sites)([1.0, 0.0], 3.0))
        errors.append(np.max(np.abs(found - exact(sites, 3.0))))
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 4, atol=0.35)


def test_dense_output_of_the_adaptive_integrator_is_as_good_as_its_end() -> None:
    sites = np.linspace(0, 1, 9)
    found = np.array(rt.schemes.Adaptive(1e-10).samples(RATE, sites)([1.0, 0.0], 3.0))
    np.testing.assert_allclose(found, exact(sites, 3.0), atol=1e-8)


def test_dense_output_meets_both_ends_of_the_step() -> None:
    for integrator in (rt.schemes.RungeKutta4(3), rt.schemes.Adaptive(1e-10)):
        found = np.array(integrator.samples(RATE, np.array([0.0, 1.0]))([1.0, 0.5], 2.0))
        np.testing.assert_array_equal(found[:, 0], [1.0, 0.5])
        end = np.array(integrator.flow(RATE)([1.0, 0.5], 2.0)).ravel()
        np.testing.assert_allclose(found[:, 1], end, atol=1e-9)


def test_the_compressed_interpolant_collocates_at_knots_and_mid_point() -> None:
    scheme = rt.schemes.CompressedHermiteSimpson()
    left = np.array([1.0, 0.2])
    step, samples = scheme.step(RATE), scheme.samples(RATE, np.array([0.0, 0.5, 1.0]))
    right = left
    for _ in range(60):  # the implicit step, by fixed-point iteration
        right = np.array(step(left, right, 0.5)[0]).ravel()
    middle = np.array(step(left, right, 0.5)[1]).ravel()
    np.testing.assert_allclose(samples(left, right, 0.5), np.array([left, middle, right]).T, atol=1e-12)


@pytest.mark.parametrize(("control", "count"), [(rt.schemes.ConstantControl(), 4), (rt.schemes.LinearControl(), 5)])
def test_controls_of_single_shooting_stand_on_the_mesh(control: rt.schemes.LinearControl, count: int) -> None:
    knots = np.array([0, 0.1, 0.3, 0.7, 1])
    shot = rt.schemes.SingleShooting(control=control).over(knots)
    assert len(shot.control_sites) == count
    assert np.all(np.diff(shot.control_sites) > 0)
    for j, (low, high) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        own = shot.control_sites[shot.controls_of(j)]
        np.testing.assert_allclose(own, low + (high - low) * shot.piece_sites)
    np.testing.assert_allclose(shot.control_at_nodes @ np.arange(count), [0, count - 1])


@dataclass(frozen=True)
class OneSided(Control):
    """A control with a site at one end of each interval."""

    places: tuple[float, ...]

    def sites(self, nodes: np.ndarray) -> np.ndarray:
        return np.array(self.places)


@pytest.mark.parametrize("places", [(0.0, 0.5), (0.5, 1.0)])
def test_a_control_with_a_site_at_one_end_shares_none_with_its_neighbours(places: tuple[float, ...]) -> None:
    shot = rt.schemes.SingleShooting(control=OneSided(places)).over(np.array([0, 0.4, 1]))
    np.testing.assert_allclose(shot.control_sites, [0.4 * places[0], 0.4 * places[1], *(0.4 + 0.6 * np.array(places))])
    assert [shot.controls_of(piece) for piece in (0, 1)] == [slice(0, 2), slice(2, 4)]


@pytest.mark.parametrize("tolerance", [0.9e-14, 1.1e-2, 0.0, -1e-6, 1.0, float("nan"), "1e-6", None])
def test_the_tolerance_of_the_adaptive_integrator_lies_between_round_off_and_a_hundredth(tolerance: object) -> None:
    for valid in (1e-14, 1e-2):
        assert rt.schemes.Adaptive(valid).tolerance == valid
    with pytest.raises(rt.InputError, match="between 1e-14 and 1e-2"):
        rt.schemes.Adaptive(tolerance)  # type: ignore[arg-type]


@pytest.mark.parametrize("scheme", [rt.schemes.CompressedHermiteSimpson(), rt.schemes.MultipleShooting()], ids=str)
def test_a_step_goes_from_knot_to_knot(scheme: rt.schemes.MultipleShooting) -> None:
    assert scheme.nodes.tolist() == [0.0, 1.0] == scheme.pieces.tolist()
