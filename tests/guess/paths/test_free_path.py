"""A random search finds free paths near a known one, and none through a wall."""

from __future__ import annotations

import numpy as np

from robotraj.guess.paths.free_path import free_path

ANYWHERE = np.full(2, 2.0)


def straight(first: tuple[float, float], last: tuple[float, float]) -> np.ndarray:
    return np.array(first) + np.linspace(0.0, 1.0, 11)[:, None] * (np.array(last) - first)


def test_a_free_path_goes_around_a_disc() -> None:
    """The path is free to the sag of a step of 0.04, and at most a third longer than the tangents to the disc."""
    known = straight((-1.0, 0.0), (1.0, 0.0))

    def free(q: np.ndarray) -> np.ndarray:
        return np.linalg.norm(q, axis=1) > 0.5

    corners = free_path(free, known, -ANYWHERE, ANYWHERE)
    assert corners is not None and np.array_equal(corners[[0, -1]], known[[0, -1]])
    for a, b in zip(corners[:-1], corners[1:], strict=True):
        # A chord of 0.04 between free configurations is at most 0.02^2 deep in a disc of 0.5.
        assert np.linalg.norm(a + np.linspace(0, 1, 300)[:, None] * (b - a), axis=1).min() > 0.5 - 0.02**2 - 1e-9
    shortest = 2 * np.sqrt(0.75) + 0.5 * (np.pi - 2 * np.arccos(0.5))
    assert np.linalg.norm(np.diff(corners, axis=0), axis=1).sum() < 4 / 3 * shortest


def test_a_wall_leaves_no_path() -> None:
    known = straight((-1.0, 0.0), (1.0, 0.0))
    assert free_path(lambda q: np.abs(q[:, 0]) > 0.1, known, -ANYWHERE, ANYWHERE) is None
