"""Winding numbers: 1 inside a closed surface, 0 outside, and the solid angle of an open one."""

from __future__ import annotations

import numpy as np
import pytest

from robotraj.robot.collision.tessellation import box_triangles
from robotraj.robot.meshes.winding import Winding


@pytest.mark.parametrize("away", [0.0, 1e3])
def test_a_closed_surface_winds_once_around_its_inner_points_and_not_around_others(away: float) -> None:
    triangles, rng = box_triangles(np.array([0.1, 0.2, 0.3])), np.random.default_rng(0)
    winding = Winding.of(triangles + away)
    for point in rng.uniform(-0.4, 0.4, (50, 3)):
        inside = bool(np.all(np.abs(point) < [0.1, 0.2, 0.3]))
        assert abs(winding.number(point + away)) == pytest.approx(float(inside), abs=1e-9)


def test_a_triangle_in_an_octant_winds_an_eighth_and_turned_over_as_much_the_other_way() -> None:
    triangle = np.eye(3)[None]
    assert Winding.of(triangle).number(np.zeros(3)) == pytest.approx(0.125, abs=1e-12)
    assert Winding.of(triangle[:, ::-1]).number(np.zeros(3)) == pytest.approx(-0.125, abs=1e-12)
