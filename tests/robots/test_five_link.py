"""five_link's motion and heel strike satisfy the paper's balances of angular momentum."""

from __future__ import annotations

import numpy as np
import pytest
from kelly2017 import BALANCES, BEFORE, TORSO, along_links, chain, five_link_map, five_link_torques, momentum
from pinned import OTHER, Planar

SAMPLES = 30


def random_step(rng):
    q = rng.uniform([-1, -1, -0.5, -1, -1], [1, 1, 0.5, 1, 1])
    return q, rng.uniform(-5, 5, 5), rng.uniform(-100, 100, 4)


@pytest.mark.parametrize("stance", ["left", "right"])
@pytest.mark.parametrize("name", TORSO)
def test_five_link_accelerates_as_the_balances_of_angular_momentum_say(name, stance):
    robot, a_map, rng = Planar(name), five_link_map(stance), np.random.default_rng(2)
    foot = f"{stance}_foot"
    for _ in range(SAMPLES):
        q, dq, u = random_step(rng)
        a, b, g = momentum(q, TORSO[name], BALANCES)
        expected = np.linalg.solve(a, b @ dq**2 + g + [0, *u])
        place = np.concatenate([[0, 0], a_map @ q])
        v = robot.standing(foot, np.concatenate([[0, 0], a_map @ dq]), place)
        found = robot.pinned(foot, place, v, five_link_torques(u, stance))
        np.testing.assert_allclose(np.linalg.solve(a_map, found[2:]), expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("stance", ["left", "right"])
@pytest.mark.parametrize("name", TORSO)
def test_five_link_has_the_papers_velocities_after_heel_strike(name, stance):
    robot, rng = Planar(name), np.random.default_rng(4)
    before, after = five_link_map(stance), five_link_map(OTHER[stance])
    for _ in range(SAMPLES):
        q, dq, _ = random_step(rng)
        kept = momentum(q, TORSO[name], BEFORE)[0] @ dq
        expected = np.linalg.solve(momentum(q[::-1], TORSO[name], BALANCES)[0], kept)
        place = np.concatenate([[0, 0], before @ q])
        v = robot.standing(f"{stance}_foot", np.concatenate([[0, 0], before @ dq]), place)
        found = robot.impact(f"{OTHER[stance]}_foot", place, v)
        np.testing.assert_allclose(np.linalg.solve(after, found[2:]), expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("stance", ["left", "right"])
def test_five_link_stands_where_the_case_has_its_points(stance):
    robot, rng = Planar("five_link"), np.random.default_rng(6)
    points, _ = chain(TORSO["five_link"])
    q = rng.uniform(-1, 1, 5)
    place = np.concatenate([[0, 0], five_link_map(stance) @ q])
    places = points @ along_links(q)[0]
    foot = robot.place(f"{stance}_foot", place)
    for frame, point in (("torso", 2), ("head", 3), (f"{OTHER[stance]}_tibia", 4), (f"{OTHER[stance]}_foot", 5)):
        np.testing.assert_allclose(robot.place(frame, place) - foot, places[point], atol=1e-14)


def test_the_two_five_links_differ_in_the_torsos_centre_of_mass_only():
    first, second = (Planar(name).model for name in TORSO)
    for one, two, link in zip(first.inertias, second.inertias, first.names, strict=True):
        assert one.mass == two.mass
        np.testing.assert_array_equal(one.inertia, two.inertia)
        np.testing.assert_array_equal(two.lever - one.lever, [0, 0, 0.2 - 0.425] if link == "root_pitch" else [0, 0, 0])
    for one, two in zip(first.jointPlacements, second.jointPlacements, strict=True):
        assert one == two


def test_the_papers_periodic_step_starts_as_the_strike_at_its_end_leaves_it():
    """States of the case's optimum (469.650), to the digits that its table has."""
    first = np.array([0.08653, 0.49315, -0.12741, -0.34671, -0.35797])
    rates, last_rates = [-1.5065, -0.6053, 0.0153, -0.5454, -2.0144], [-2.1747, -1.6220, 1.0270, -1.3786, 2.9906]
    robot, before, after = Planar("five_link"), five_link_map("left"), five_link_map("right")
    place = np.concatenate([[0, 0], before @ first[::-1]])
    np.testing.assert_allclose(place[2:], after @ first, atol=1e-15)
    np.testing.assert_allclose(robot.place("right_foot", place) - robot.place("left_foot", place), [0.5, 0], atol=2e-5)
    v = robot.standing("left_foot", np.concatenate([[0, 0], before @ last_rates]), place)
    found = robot.impact("right_foot", place, v)[2:]
    np.testing.assert_allclose(np.linalg.solve(after, found), rates, atol=5e-4)
    assert min(place[[4, 6]]) > 0  # both knees bend as they can
