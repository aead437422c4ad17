"""Overlaps of configurations, and configurations at the edge of an overlap."""

from __future__ import annotations

import numpy as np

import robotraj as rt
from robotraj.robot.collision.along_motion import freed, near_pairs, pairs_within
from robotraj.robot.collision.own_body import own_body
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import touch

FREE, OVERLAPS = np.array([0, -1.5, 0.5, 0.6, 0, 0]), np.array([0, -1.5, 0.5, 1.55, 0, 0])
MARGIN = 1e-3


def test_pairs_within_a_margin_of_nothing_are_those_that_touch() -> None:
    arm, rng = rt.load("ur5"), np.random.default_rng(3)
    body, q = own_body(arm), rng.uniform(-3, 3, (20, 6))
    found = pairs_within(arm, body, q)
    for each, turned, moved in zip(found, *placements(arm, q), strict=True):
        placed = [body.placed(shape, turned, moved) for shape in range(len(body.solids))]
        assert each.tolist() == [touch(placed[a], placed[b]) for a, b in body.pairs.tolist()]
    assert found.any() and not found.all(axis=0).any()


def test_a_wider_margin_has_more_pairs() -> None:
    arm, rng = rt.load("ur5"), np.random.default_rng(4)
    body, q = own_body(arm), rng.uniform(-3, 3, (20, 6))
    narrow, wide = (pairs_within(arm, body, q, margin) for margin in (0.0, 4e-3))
    assert np.all(narrow <= wide) and narrow.sum() < wide.sum()


def test_freed_configurations_are_a_margin_apart_at_the_edge_of_the_overlap() -> None:
    arm = rt.load("ur5")
    body = own_body(arm)
    (pair,) = np.flatnonzero(pairs_within(arm, body, OVERLAPS[None])[0])
    q, free = np.array([FREE, OVERLAPS]), np.array([FREE, FREE])
    moved = freed(arm, body, pair, q, free, MARGIN)
    assert np.array_equal(moved[0], FREE)
    assert FREE[3] < moved[1, 3] < OVERLAPS[3]
    assert not pairs_within(arm, body, moved, MARGIN)[:, pair].any()
    assert pairs_within(arm, body, moved[1:] + [[0, 0, 0, 0.01, 0, 0]], MARGIN)[0, pair]


def test_some_times_of_overlaps_name_the_same_pairs_as_all_times() -> None:
    arm, rng = rt.load("ur5"), np.random.default_rng(5)
    body, knots, seen = own_body(arm), np.linspace(0.0, 0.5, 9), 0
    for _ in range(4):
        first, last = rng.uniform(-3, 3, (2, 6))
        speeds = np.tile(np.abs(last - first) / 0.5, (8, 1))

        def motion(times, first=first, last=last):
            return first + (last - first) * np.asarray(times)[:, None] / 0.5

        some, every = (
            {
                each.pair: each.times
                for each in near_pairs(arm, body, motion, knots, speeds, every=every)
                if each.overlaps
            }
            for every in (False, True)
        )
        assert some.keys() == every.keys()
        for pair, times in some.items():
            assert pairs_within(arm, body, motion(times))[:, pair].all()
        seen += len(some)
    assert seen
