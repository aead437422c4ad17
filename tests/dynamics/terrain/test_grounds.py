"""Every ground gives one surface on symbols, numbers and arrays; its normals and tangents are that surface's."""

from __future__ import annotations

import pickle
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

import robotraj as rt
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground

RANDOM = np.random.default_rng(4)
HILLS = rt.terrain.HeightMap(0.1 * RANDOM.standard_normal((7, 5)), (0.4, 0.3), (-1.2, -0.6))
GROUNDS = {
    "flat": rt.terrain.Flat(0.3),
    "slope": rt.terrain.Slope(0.2, -0.4, 0.1),
    "steps": rt.terrain.Steps([-0.5, 0.2, 0.9], [0.0, 0.15, 0.3, 0.1], 0.3),
    "height map": HILLS,
    "function": rt.terrain.HeightFunction(lambda x, y: 0.1 * ca.sin(3 * x) * ca.cos(2 * y)),
    "lowest": rt.terrain.Lowest([rt.terrain.Slope(0.2, -0.4, 0.1), HILLS]),
    "plain function": as_ground(lambda x, y: 0.1 * x**3 + y**2),
}
PLACES = RANDOM.uniform(-1.1, 1.1, (40, 2)) * [1.0, 0.5]


@pytest.fixture(params=GROUNDS)
def ground(request: pytest.FixtureRequest) -> Ground:
    return GROUNDS[request.param]


def test_symbols_numbers_and_arrays_agree(ground: Ground) -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    symbolic = ca.Function(
        "all", [x, y], [ca.vertcat(*ground.at(x, y), *ground.normal(x, y), *sum(ground.axes(x, y), []))]
    )
    mx, my = ca.MX.sym("x"), ca.MX.sym("y")
    matrix = ca.Function("height", [mx, my], [ground.height(mx, my)])
    heights, axes = ground.height(*PLACES.T), ground.axes(*PLACES.T)
    assert heights.shape == (40,)
    for i, (a, b) in enumerate(PLACES):
        expected = [*ground.at(a, b), *ground.normal(a, b), *sum(ground.axes(a, b), [])]
        assert all(isinstance(value, float) for value in expected)
        np.testing.assert_allclose(np.array(symbolic(a, b)).ravel(), expected, atol=1e-14)
        assert float(matrix(a, b)) == pytest.approx(heights[i], abs=1e-14)
        assert float(ground.height(ca.DM(a), ca.DM(b))) == pytest.approx(heights[i], abs=1e-14)
        assert heights[i] == pytest.approx(expected[2], abs=1e-14)
        np.testing.assert_allclose([np.asarray(s)[..., i] for axis in axes for s in axis], expected[6:], atol=1e-14)


def test_axes_are_right_handed_and_touch_the_surface(ground: Ground) -> None:
    step = 1e-6
    for x, y in PLACES:
        t1, t2, n = (np.array(axis) for axis in ground.axes(x, y))
        np.testing.assert_allclose(np.array([t1, t2, n]) @ np.array([t1, t2, n]).T, np.eye(3), atol=1e-14)
        np.testing.assert_allclose(np.cross(t1, t2), n, atol=1e-14)
        np.testing.assert_allclose(ground.normal(x, y), n, atol=1e-15)
        assert t1[1] == 0.0 and t1[0] > 0.0 and n[2] > 0.0
        for dx, dy in ((step, 0.0), (0.0, step)):
            rise = ground.height(x + dx, y + dy) - ground.height(x - dx, y - dy)
            assert n @ [2 * dx, 2 * dy, rise] == pytest.approx(0.0, abs=1e-12)


def test_surfaces_are_twice_differentiable(ground: Ground) -> None:
    """Exact second derivatives are those of finite differences, across every seam."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    hessian, gradient = ca.hessian(ground.height(x, y), ca.vertcat(x, y))
    second, first = ca.Function("h", [x, y], [hessian]), ca.Function("g", [x, y], [gradient])
    step = 1e-6
    for a, b in [*PLACES, (-0.8, 0.0), (-0.4, 0.3), (0.2, 0.1)]:
        numeric = [(first(a + step, b) - first(a - step, b)), (first(a, b + step) - first(a, b - step))]
        curvature = np.array(ca.horzcat(*numeric)) / (2 * step)
        np.testing.assert_allclose(np.array(second(a, b)), curvature, atol=1e-3)


def test_a_grid_samples_the_surface(ground: Ground) -> None:
    x, y, heights = ground.grid((-1.0, 0.5), (-0.2, 0.4), 6)
    assert (x[0], x[-1], y[0], y[-1]) == (-1.0, 0.5, -0.2, 0.4)
    assert {*np.linspace(-1.0, 0.5, 6)} <= {*x} and len(y) == 6
    assert heights.shape == (len(x), len(y))
    assert heights[2, 5] == pytest.approx(ground.height(x[2], y[5]), abs=1e-14)


def test_a_used_ground_can_be_pickled() -> None:
    for name in ("flat", "slope", "steps", "height map"):
        ground = GROUNDS[name]
        before = ground.height(0.1, 0.2)
        copy = pickle.loads(pickle.dumps(ground))
        assert (copy, hash(copy)) == (ground, hash(ground))
        assert copy.height(0.1, 0.2) == before
    assert rt.terrain.HeightMap(np.zeros((4, 4)), (1, 1)) != rt.terrain.HeightMap(np.eye(4), (1, 1))


def test_treads_are_exact_and_the_ground_never_lies_below_the_stair() -> None:
    steps = rt.terrain.Steps([0.4, 0.8, 1.2], [0.0, 0.15, 0.3, 0.1], 0.06)
    assert steps.treads == ((-np.inf, 0.34, 0.0), (0.4, 0.74, 0.15), (0.8, 1.2, 0.3), (1.26, np.inf, 0.1))
    for low, high, height in steps.treads:
        xs = np.linspace(max(low, -1.0), min(high, 2.0), 50)
        np.testing.assert_allclose(steps.height(xs, 0.0), height, atol=1e-15)
        np.testing.assert_allclose(steps.normal(xs, 0.0)[2], 1.0, atol=1e-15)
    xs = np.linspace(-1, 2, 3001)
    true = np.array(steps.heights)[np.searchsorted(steps.edges, xs, side="right")]
    at_edge = np.isclose(xs[:, None], steps.edges).any(axis=1)
    assert np.all((steps.height(xs, 0.0) >= true - 1e-12)[~at_edge])


def test_a_foot_may_stand_on_treads_and_on_no_riser() -> None:
    steps = rt.terrain.Steps.stairs(0.5, 0.3, 0.15, 4, 0.05)
    assert steps.edges == pytest.approx((0.5, 0.8, 1.1, 1.4))
    assert steps.heights == pytest.approx((0.0, 0.15, 0.3, 0.45, 0.6))
    xs = np.linspace(0.0, 2.0, 4001)
    stands = np.min(steps.footing(xs, 0.0), axis=0) >= 0.0
    level = np.isin(np.round(steps.height(xs, 0.0), 12), np.round(steps.heights, 12))
    inside = np.any([(xs > low + 1e-9) & (xs < high - 1e-9) for low, high in steps.risers], axis=0)
    assert not stands[inside].any() and stands[~inside & level].mean() > 0.99
    low, high = steps.risers[1]
    distance = steps.footing(np.array([low - 0.01, high + 0.01]), 0.0)[1]
    assert np.all((distance > 0.01 - 1e-12) & (distance < 0.013))
    heel_and_toe = np.min(steps.footing(xs, 0.0, (0.11, 0.05)), axis=0) >= 0.0
    alike = np.isclose(steps.height(xs - 0.11, 0.0), steps.height(xs + 0.11, 0.0), atol=1e-12)
    assert heel_and_toe.any() and alike[heel_and_toe].all() and stands[heel_and_toe].all()
    assert heel_and_toe.sum() >= (alike & level).sum() - 20
    assert rt.terrain.Slope(0.3).footing(0.0, 0.0) == []


def test_a_height_map_is_scipys_spline_and_runs_on_straight() -> None:
    x, y = np.linspace(-1.2, 1.2, 7), np.linspace(-0.6, 0.6, 5)
    spline = RectBivariateSpline(x, y, HILLS.heights, s=0)
    xs, ys = RANDOM.uniform(-1.2, 1.2, 300), RANDOM.uniform(-0.6, 0.6, 300)
    np.testing.assert_allclose(HILLS.height(xs, ys), spline.ev(xs, ys), atol=1e-13)
    np.testing.assert_allclose(HILLS.height(x[:, None], y[None, :]), HILLS.heights, atol=1e-14)
    scale = HILLS.normal(xs, ys)[2]
    np.testing.assert_allclose(-HILLS.normal(xs, ys)[0] / scale, spline.ev(xs, ys, dx=1), atol=1e-12)
    beyond = spline.ev(1.2, 0.1) + 0.5 * spline.ev(1.2, 0.1, dx=1)
    assert HILLS.height(1.7, 0.1) == pytest.approx(float(beyond), abs=1e-13)
    corner = spline.ev(-1.2, 0.6) - 0.2 * spline.ev(-1.2, 0.6, dx=1) + 0.1 * spline.ev(-1.2, 0.6, dy=1)
    corner -= 0.02 * spline.ev(-1.2, 0.6, dx=1, dy=1)
    assert HILLS.height(-1.4, 0.7) == pytest.approx(float(corner), abs=1e-12)
    np.testing.assert_allclose(HILLS.normal(1.2 - 1e-9, 0.1), HILLS.normal(1.2 + 1e-9, 0.1), atol=1e-7)


def test_a_height_map_takes_the_places_of_its_samples() -> None:
    x, y = np.linspace(-1.2, 1.2, 7), np.linspace(-0.6, 0.6, 5)
    same = rt.terrain.HeightMap.from_array(x, y, HILLS.heights)
    assert (same.spacing, same.origin) == (pytest.approx(HILLS.spacing), pytest.approx(HILLS.origin))
    cubic = rt.terrain.HeightMap.from_array(np.arange(4), np.arange(6), np.arange(4)[:, None] ** 3 + 0.0 * np.arange(6))
    assert cubic.height(1.3, 2.2) == pytest.approx(1.3**3, abs=1e-12)


def test_a_slope_in_degrees_or_percent_is_doubted():
    with pytest.warns(UserWarning, match=r"10 degrees are 0\.1763, 10 percent 0\.1\."):
        rt.terrain.Slope(10.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rt.terrain.Flat(np.nan), ["rt.terrain.Flat", "nan"]),
        (lambda: rt.terrain.Slope(np.inf), ["slope_x=inf", "rise over run"]),
        (lambda: rt.terrain.Steps([0.0, 1.0], [0.0, 0.1]), ["2 edges", "2 heights"]),
        (lambda: rt.terrain.Steps([0.0, 0.03], [0.0, 0.1, 0.2]), ["0.03 m", "ramps of 0.04 m"]),
        (lambda: rt.terrain.Steps([1.0, 0.0], [0.0, 0.1, 0.2]), ["increase"]),
        (lambda: rt.terrain.Steps([0.0], [0.0, np.nan]), ["nan", "finite"]),
        (lambda: rt.terrain.Steps([0.0], [0.0, 0.1], 0.0), ["positive width"]),
        (lambda: rt.terrain.HeightMap(np.zeros((3, 9)), (1, 1)), ["(3, 9)", "at least 4"]),
        (lambda: rt.terrain.HeightMap(np.full((4, 4), np.nan), (1, 1)), ["heights[0, 0]", "16"]),
        (lambda: rt.terrain.HeightMap(np.zeros((4, 4)), (1, 0)), ["spacing", "positive"]),
        (lambda: rt.terrain.HeightMap(np.zeros((4, 4)), 1.0), ["spacing", "two numbers"]),
        (
            lambda: rt.terrain.HeightMap.from_array([0, 1, 2, 4], range(4), np.zeros((4, 4))),
            ["x", "1 to 2 m", "resample"],
        ),
        (lambda: rt.terrain.HeightMap.from_array(range(4), range(5), np.zeros((4, 4))), ["5 values of y"]),
        (lambda: as_ground(3.0), ["rt.terrain.Flat", "3.0"]),
        (lambda: as_ground(lambda x, y: x if x > 0 else y).height(0.0, 0.0), ["height function", "`if`"]),
        (lambda: as_ground(lambda x, y: ca.vertcat(x, y)).height(0.0, 0.0), ["2 values"]),
    ],
)
def test_what_is_no_ground_is_refused(make: Any, words: list[str]) -> None:
    with pytest.raises(rt.InputError) as error:
        make()
    for word in words:
        assert word in str(error.value)


def test_the_lowest_of_several_grounds_is_below_all_of_them() -> None:
    parts = [GROUNDS["flat"], GROUNDS["slope"], GROUNDS["steps"]]
    lowest = rt.terrain.Lowest(parts)
    heights = [each.height(*PLACES.T) for each in parts]
    np.testing.assert_allclose(lowest.height(*PLACES.T), np.min(heights, axis=0), atol=1e-12)
    assert {-0.5, 0.2, 0.9} <= set(np.round(lowest.bends()[0], 12))
    with pytest.raises(rt.InputError, match="no wall"):
        rt.terrain.Lowest([rt.terrain.Plane((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))])
