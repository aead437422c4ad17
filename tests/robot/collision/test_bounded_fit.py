"""Spheres around a mesh of many long triangles take bounded time and memory, and enclose it."""

from __future__ import annotations

import time

import numpy as np

from robotraj.robot.collision.enclosing_spheres import MANY, MOST_PIECES, enclose, encloses
from robotraj.robot.collision.tessellation import box_triangles, hull_triangles, sphere_points


def test_long_triangles_are_subdivided_less() -> None:
    rng = np.random.default_rng(0)
    triangles = rng.normal(size=(3000, 3))[rng.integers(0, 3000, (120_000, 3))]
    began = time.process_time()
    fit = enclose(triangles)
    assert time.process_time() - began < 60.0
    assert encloses(fit.centres, fit.radii, triangles)
    assert len(triangles) < MOST_PIECES


def test_a_detail_of_many_triangles_beside_a_plain_body() -> None:
    ball = hull_triangles(sphere_points(30_000))
    body = box_triangles(np.array([0.1, 0.05, 0.2]))
    triangles = np.concatenate([body, *(0.01 * ball + [0.1, 0.0, 0.001 * k] for k in range(4))])
    assert len(triangles) > 4 * MANY
    began = time.process_time()
    fit, alone = enclose(triangles), enclose(body)
    assert time.process_time() - began < 20.0
    assert encloses(fit.centres, fit.radii, triangles)
    # The body is subdivided as it is without the detail.
    assert fit.protrusion < 1.5 * alone.protrusion
    assert fit.volume < 1.5 * alone.volume
