"""Spheres around a mesh of many long triangles take bounded time and memory, and enclose it."""

from __future__ import annotations

import time

import numpy as np

from robotraj.robot.collision.enclosing_spheres import MOST_PIECES, enclose, encloses


def test_long_triangles_are_subdivided_less() -> None:
    rng = np.random.default_rng(0)
    triangles = rng.normal(size=(3000, 3))[rng.integers(0, 3000, (120_000, 3))]
    began = time.process_time()
    fit = enclose(triangles)
    assert time.process_time() - began < 60.0
    assert encloses(fit.centres, fit.radii, triangles)
    assert len(triangles) < MOST_PIECES
