"""Rows on distances: one block for each function, and numbers that later rows do not change."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.clearance.clearance_rows import clearances, with_clearance_rows
from robotraj.transcription.clearance.distance_functions import function_of, key_of
from robotraj.transcription.clearance.near_pairs import nearest_along
from robotraj.transcription.nlp import Nlp
from tests.programs import nlp_of

BALLS = [rt.obstacles.Sphere(0.05, (0.5, 0.0, 0.5)), rt.obstacles.Sphere(0.05, lambda t: (0.4, 0.1 * t, 0.4))]


@pytest.fixture(scope="module")
def plain() -> Nlp:
    ends = (rt.State(q=np.full(6, -0.5), v=0), rt.State(q=np.full(6, 0.5), v=0))
    free = rt.CollisionFree(BALLS, self_collision=True)
    return nlp_of(rt.Problem([rt.Phase(rt.load("ur5"), 1.0, *ends, rt.Effort(), constraints=[free])]), rt.Mesh(6))


def added(plain: Nlp, raised: dict[tuple[int, int], float]) -> Nlp:
    """Return the NLP with rows whose planes follow the straight line."""
    own = clearances(plain)[0]

    def line(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return -0.5 + np.tile(s[:, None], 6), s

    nearest = nearest_along(own.pairs, plain.layouts[0], line)
    return with_clearance_rows(plain, [own], [raised], [line], [nearest])


def test_later_rows_leave_the_numbers_of_earlier_ones(plain: Nlp) -> None:
    count = len(clearances(plain)[0].pairs)
    first = {(interval, pair): 0.0 for interval in (4, 1) for pair in range(0, count, 7)}
    later = {place: 0.01 for place in first} | {(0, pair): 0.0 for pair in range(count)}
    few, many = added(plain, first), added(plain, later)
    size = len(few.rows)
    np.testing.assert_array_equal(few.values(few.guess), many.values(few.guess)[:size])
    np.testing.assert_array_equal(few.rows.fraction, many.rows.fraction[:size])
    old = slice(len(plain.rows), size)
    np.testing.assert_allclose(many.rows.lower[old], few.rows.lower[old] + 0.01, atol=1e-15)


def test_pairs_with_one_function_share_one_block(plain: Nlp) -> None:
    pairs = clearances(plain)[0].pairs
    everything = {(interval, pair): 0.0 for interval in range(6) for pair in range(len(pairs))}
    blocks = added(plain, everything).blocks[len(plain.blocks) :]
    moving = [pair for pair in range(len(pairs)) if function_of(pairs, pair).positions.size]
    assert len(blocks) == len({key_of(pairs, pair) for pair in moving})


def test_no_pairs_add_no_rows(plain: Nlp) -> None:
    assert added(plain, {}) is plain
