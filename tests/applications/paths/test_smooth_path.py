"""Smooth paths: near the given ones, within the limits of position, and never rougher."""

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.applications import as_path
from robotraj.applications.paths.smooth_path import smoothed

FREE = np.full(2, np.inf)


def corner():
    """Return two straight lines with a right angle between them, over [0, 2]."""
    ends = np.array([0.0, 1.0])
    lines = [np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[1.0, 0.0], [1.0, 1.0]])]
    return PiecewisePolynomial(np.array([0.0, 1.0, 2.0]), [ends, ends], lines)


@pytest.mark.parametrize("deviation", [1e-1, 1e-2, 1e-3, 1e-4])
def test_a_corner_is_rounded_within_the_deviation(deviation):
    path = smoothed(corner(), deviation, -FREE, FREE)
    s = np.linspace(0.0, 2.0, 2001)
    far = np.abs(path(s) - corner()(s)).max()
    assert 0.5 * deviation < far <= 1.01 * deviation
    assert np.allclose(path(np.array([0.0, 2.0])), [[0.0, 0.0], [1.0, 1.0]])
    for _ in range(4):
        path = path.derivative()
        before, after = (path(path.breaks[1:-1], k + np.arange(len(path.breaks) - 2)) for k in (0, 1))
        assert np.allclose(before, after, rtol=1e-4, atol=1e-4 * np.abs(before).max())


def test_it_stays_within_limits_of_position():
    upper = np.array([1.0, np.inf])
    path = smoothed(corner(), 1e-2, -FREE, upper)
    assert path(np.linspace(0.0, 2.0, 2001)).max(axis=0)[0] <= 1.0 + 1e-12
    assert smoothed(corner(), 1e-2, -FREE, FREE)(np.linspace(0.0, 2.0, 2001)).max(axis=0)[0] > 1.0


def test_a_smooth_path_is_hardly_changed():
    x = np.linspace(0.0, 1.0, 7)
    given = as_path(np.column_stack([x, np.sin(2.0 * x)]))
    path = smoothed(given, 1e-6, -FREE, FREE)
    places = np.linspace(0.0, 1.0, 501)
    curve = path(np.linspace(path.breaks[0], path.breaks[-1], 20001))
    assert np.linalg.norm(given(places)[:, None] - curve[None], axis=2).min(axis=1).max() < 2e-4


def test_rests_are_left_out():
    ends = np.array([0.0, 1.0])
    lines = [np.array([[0.0], [1.0]]), np.array([[1.0], [1.0]]), np.array([[1.0], [3.0]])]
    path = smoothed(PiecewisePolynomial(np.arange(4.0), [ends] * 3, lines), 1e-3, -FREE[:1], FREE[:1])
    assert path.breaks[-1] == pytest.approx(3.0)
    s = np.linspace(0.0, 3.0, 301)
    assert np.abs(path(s)[:, 0] - s).max() <= 1e-3


def test_too_small_a_deviation_is_refused():
    with pytest.raises(rt.InputError, match="No spline of 512 pieces"):
        smoothed(corner(), 1e-14, -FREE, FREE)
