"""A plane in any attitude: its points, normals and gaps are those of the plane equation."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt

RANDOM = np.random.default_rng(3)
PLANES = [(RANDOM.uniform(-1, 1, 3), RANDOM.standard_normal(3)) for _ in range(24)]
AXES = [(np.array([0.3, -0.2, 0.5]), sign * axis) for axis in np.eye(3) for sign in (1.0, -1.0)]


@pytest.mark.parametrize(("point", "outward"), [*PLANES, *AXES])
def test_points_axes_and_gaps_are_those_of_the_plane(point: np.ndarray, outward: np.ndarray) -> None:
    plane, normal = rt.terrain.Plane(point, outward), outward / np.linalg.norm(outward)
    assert abs(normal[plane.axis]) == pytest.approx(np.abs(normal).max())
    assert plane.below == (plane.axis == 2 and normal[2] > 0.0)
    for u, v, away in RANDOM.uniform(-2, 2, (5, 3)):
        place = np.array(plane.at(u, v))
        assert (place - point) @ normal == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(place[list(plane.plan)], [u, v])
        axes = np.array(plane.axes(u, v))
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(np.cross(axes[0], axes[1]), axes[2], atol=1e-12)
        np.testing.assert_allclose(axes[2], normal, atol=1e-12)
        np.testing.assert_allclose(plane.normal_at(place), normal, atol=1e-12)
        lifted = place + away * normal
        assert plane.gap(lifted) * abs(normal[plane.axis]) == pytest.approx(away, abs=1e-12)
        symbol = ca.SX.sym("p", 3)
        gap = ca.Function("gap", [symbol], [plane.gap(ca.vertsplit(symbol))])
        assert float(gap(lifted)) == pytest.approx(plane.gap(lifted), abs=1e-12)


def test_an_upward_plane_is_a_slope() -> None:
    slope = rt.terrain.Slope(0.3, -0.4, 0.2)
    plane = rt.terrain.Plane(slope.at(0.7, -0.1), (-0.3, 0.4, 1.0))
    assert plane.below and plane.even
    for x, y in RANDOM.uniform(-1, 1, (5, 2)):
        np.testing.assert_allclose(plane.at(x, y), slope.at(x, y))
        np.testing.assert_allclose(plane.axes(x, y), slope.axes(x, y), atol=1e-12)


@pytest.mark.parametrize(
    ("point", "outward", "words"),
    [((0, 0), (1, 0, 0), "point is"), ((0, 0, 0), (0, 0, 0), "length zero"), ((0, 0, 0), (np.nan, 0, 1), "outward is")],
)
def test_other_vectors_are_refused(point: object, outward: object, words: str) -> None:
    with pytest.raises(rt.InputError, match=words):
        rt.terrain.Plane(point, outward)  # type: ignore[arg-type]


def test_gaits_walk_on_grounds_below_them() -> None:
    wall = rt.terrain.Plane((1, 0, 0), (-1, 0, 0))
    with pytest.raises(rt.InputError, match="no gait walks"):
        rt.gait.walk(rt.load("five_link", root="planar"), step_length=0.3, duration=0.5, ground=wall)
