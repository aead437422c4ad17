"""Pairs of links whose spheres overlap without their shapes are checked by the witness alone, with exact shapes."""

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.collision.link_pairs import too_coarse
from robotraj.robot.collision.robot_spheres import robot_spheres


def pairs_of(robot):
    spheres = robot_spheres(robot)
    return {frozenset((spheres.links[a], spheres.links[b])) for a, b in spheres.link_pairs}


def test_wrists_that_never_touch_are_not_planned_by_spheres():
    pairs = pairs_of(rt.load("ur10"))
    assert frozenset(("wrist_1_link", "wrist_3_link")) not in pairs
    assert frozenset(("base_link", "upper_arm_link")) not in pairs
    # The shapes of these links touch too.
    assert frozenset(("upper_arm_link", "wrist_1_link")) in pairs
    assert frozenset(("shoulder_link", "forearm_link")) in pairs


def test_a_pair_is_coarse_where_shapes_seldom_agree_with_spheres():
    robot = rt.load("ur5")
    links = ("forearm_link", "wrist_2_link", "upper_arm_link", "wrist_1_link")
    pairs = np.array([(0, 1), (2, 3)])

    class Overlapping:
        def self_distances(self, robot, q):
            return np.full((len(q), 2), -1.0)

    class Apart:
        def self_distances(self, robot, q):
            return np.ones((len(q), 2))

    np.testing.assert_array_equal(too_coarse(robot, links, pairs, Overlapping()), [True, True])
    np.testing.assert_array_equal(too_coarse(robot, links, pairs, Apart()), [False, False])


@pytest.mark.parametrize("name", ["ur3", "ur5", "ur10"])
def test_most_configurations_of_an_arm_are_free(name):
    robot = rt.load(name)
    rng = np.random.default_rng(0)
    free = 0
    for _ in range(40):
        q = rng.uniform(-2.5, 2.5, robot.nq)
        try:
            rt.Phase(robot, 1.0, start=rt.State(q=q, v=0), constraints=[rt.CollisionFree()])
            free += 1
        except rt.InputError as error:
            assert "overlap" in str(error)
    assert free > 24
