"""Routes leave a known motion only where it is not free."""

from __future__ import annotations

import numpy as np
import pytest

from robotraj.guess.paths.around_itself import SAMPLES, route_around

BOUNDS = np.full(2, -2.0), np.full(2, 2.0)


def across(fractions: np.ndarray) -> np.ndarray:
    return np.column_stack([2.0 * fractions - 1.0, 0.0 * fractions])


def outside(q: np.ndarray) -> np.ndarray:
    """Whether configurations are outside a disc of radius 0.2."""
    return np.asarray(np.linalg.norm(q, axis=1) > 0.2)


@pytest.mark.parametrize("seed", range(4))
def test_a_route_is_free_and_has_the_ends_of_the_motion(seed: int) -> None:
    route = route_around(across, 2.0, outside, BOUNDS, seed, whole=bool(seed % 2))
    assert route is not None and route.duration >= 2.0
    # Straight motions are compared every 0.04, so that they may cut the disc by 0.001.
    assert np.linalg.norm(route.samples, axis=1).min() > 0.199
    np.testing.assert_allclose(route.samples[[0, -1]], across(np.array([0.0, 1.0])))


def test_a_route_is_the_motion_itself_far_from_the_overlap() -> None:
    route = route_around(across, 2.0, outside, BOUNDS, 0)
    assert route is not None
    early = route(np.linspace(0.0, 0.2, 20) * 2.0 / route.duration)
    np.testing.assert_allclose(early, across(np.linspace(0.0, 0.2, 20)), atol=1e-9)


def test_velocities_of_a_route_are_its_derivatives() -> None:
    route = route_around(across, 2.0, outside, BOUNDS, 0)
    assert route is not None
    s, duration = np.linspace(0.0, 1.0, SAMPLES), 3.0
    q, v, _ = route.motion(s, duration)
    inner = slice(2, -2)
    np.testing.assert_allclose(v[inner], (q[3:-1] - q[1:-3]) / (2 * duration / (SAMPLES - 1)), atol=1e-9)
    assert not v[[0, -1]].any()


def test_no_route_leads_from_an_end_that_is_not_free() -> None:
    assert route_around(across, 2.0, lambda q: q[:, 0] > -0.9, BOUNDS, 0) is None
