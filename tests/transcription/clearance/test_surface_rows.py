"""Rows that keep links apart equal the distance of their shapes where they are fixed, on every mesh."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.collision.own_body import own_body
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import distance, hull_distance
from robotraj.transcription.clearance.state_places import state_places, states_between
from robotraj.transcription.clearance.surface_points import APART
from robotraj.transcription.clearance.surface_rows import FRACTIONS, NearPair, NearSurfaces, with_surface_rows
from robotraj.transcription.nlp import Nlp
from tests.programs import nlp_of

FIRST, LAST = np.array([0, -1.5, 0.5, 0.6, 0, 0]), np.array([0.3, -1.5, 0.5, 1.15, 0.2, 0])
"""The wrist of a ur5 comes near its forearm."""


def swing(fractions: np.ndarray) -> np.ndarray:
    return np.asarray(FIRST + np.asarray(fractions)[:, None] * (LAST - FIRST))


def along_swing(count: int) -> tuple[Nlp, np.ndarray]:
    """A program, and its variables where the states are those of the known motion."""
    phase = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=FIRST, v=0), rt.State(q=LAST, v=0), rt.Effort())
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(count))
    places, w = state_places(nlp.layouts[0]), nlp.guess.copy()
    w[places.columns[:, :6]] = swing(places.fractions)
    return nlp, w


@pytest.mark.parametrize("count", [7, 10])
def test_states_between_the_points_of_a_straight_motion_lie_on_it(count: int) -> None:
    nlp, w = along_swing(count)
    for s, state in zip(FRACTIONS.tolist(), states_between(nlp.layouts[0], FRACTIONS), strict=True):
        assert state.weights.sum() == pytest.approx(1.0)
        np.testing.assert_allclose(state.weights @ w[state.columns[:, :6]], swing(np.array([s]))[0], atol=1e-12)


@pytest.mark.parametrize("label", ["wrist_2_link and forearm_link", "wrist_3_link and upper_arm_link"])
def test_the_least_row_of_a_place_is_the_distance(label: str) -> None:
    """Of the shapes, or of their convex hulls where these are apart."""
    robot = rt.load("ur5")
    body = own_body(robot)
    pair = next(k for k in range(len(body.pairs)) if body.label(k) == label)
    a, b = body.pairs[pair].tolist()
    expected = np.full(len(FRACTIONS), np.inf)
    for k, (turned, moved) in enumerate(zip(*placements(robot, swing(FRACTIONS)), strict=True)):
        first, second = body.placed(a, turned, moved), body.placed(b, turned, moved)
        hulls = hull_distance(first, second)
        expected[k] = hulls if hulls > APART else distance(first, second)
    found = []
    for count in (7, 10):
        nlp, w = along_swing(count)
        longer = with_surface_rows(
            nlp, [NearSurfaces(robot, body, (NearPair(pair, swing(FRACTIONS), 1e-3, (0, 0), np.inf),))]
        )
        new = slice(len(nlp.rows), None)
        least = np.full(len(FRACTIONS), np.inf)
        np.minimum.at(least, np.searchsorted(FRACTIONS, longer.rows.fraction[new] - 1e-9), longer.values(w)[new])
        found.append(least)
    np.testing.assert_allclose(found[0], expected, atol=1e-6)
    np.testing.assert_allclose(found[1], found[0], atol=1e-9)


def test_rows_reach_no_further_than_they_should() -> None:
    robot, (nlp, _) = rt.load("ur5"), along_swing(5)
    body = own_body(robot)
    pair = next(k for k in range(len(body.pairs)) if body.label(k) == "wrist_3_link and upper_arm_link")
    every, none = (
        with_surface_rows(nlp, [NearSurfaces(robot, body, (NearPair(pair, swing(FRACTIONS), 1e-3, (0, 0), reach),))])
        for reach in (np.inf, 0.0)
    )
    assert len(every.rows) == len(nlp.rows) + len(FRACTIONS) and none is nlp
