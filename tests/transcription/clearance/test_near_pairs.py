"""Pairs that come near each other along a motion, and the nearest ones of two links."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.clearance.near_pairs import FURTHER, Nearest, near_pairs, nearest_of_links
from robotraj.transcription.clearance.proof import Shortfalls


@pytest.fixture(scope="module")
def pairs() -> ClearancePairs:
    return rt.CollisionFree([rt.obstacles.Sphere(0.1, (0.5, 0, 0.5))]).pairs(rt.load("ur5"))


def alike(pairs: ClearancePairs) -> np.ndarray:
    """Return pairs of one link and one obstacle."""
    counts = np.bincount(pairs.of_links[: pairs.against])
    return np.flatnonzero(pairs.of_links == counts.argmax())


def test_pairs_of_the_same_names_have_the_same_number(pairs: ClearancePairs) -> None:
    names = [tuple(sorted(pairs.names(pair))) for pair in range(len(pairs))]
    found = dict(zip(pairs.of_links.tolist(), names, strict=True))
    assert [found[number] for number in pairs.of_links.tolist()] == names
    assert len(found) == len(set(names))


def test_only_pairs_within_the_given_distance_are_near(pairs: ClearancePairs) -> None:
    distances = np.full((2, len(pairs)), 1.0)
    a, b, c = alike(pairs)[:3].tolist()
    distances[1, [a, b, c]] = 0.004, 0.008, 0.03
    nearest = Nearest(np.zeros(distances.shape), distances)
    assert near_pairs(pairs, nearest, 0.01).tolist() == [[1, a], [1, b]]
    assert near_pairs(pairs, nearest, 0.05).tolist() == [[1, a], [1, b]]  # c is further than the nearest of its link


def test_the_deepest_shortfalls_of_two_links_are_chosen(pairs: ClearancePairs) -> None:
    a, b, c = alike(pairs)[:3].tolist()
    intervals, chosen = np.array([0, 0, 1, 2]), np.array([a, b, b, c])
    distances = np.array([-0.05, -0.05 + 1.5 * FURTHER, -0.05 + 1.5 * FURTHER, -np.inf])
    found = Shortfalls(intervals, chosen, np.zeros(4), distances, -0.05, (a, 0.0))
    assert nearest_of_links(pairs, found) == [True, False, True, True]
    nothing = np.zeros(0, dtype=int)
    assert nearest_of_links(pairs, Shortfalls(nothing, nothing, np.zeros(0), np.zeros(0), np.inf, (-1, 0.0))) == []
