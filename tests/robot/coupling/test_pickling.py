"""Robots whose joints follow others survive pickles and copies, as do the parts of joined ones."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.coupling.mimics import Mimic
from tests.robot.coupling.random_trees import random_tree


def moved(robot, seed=0):
    rng = np.random.default_rng(seed)
    q, v, a = rng.normal(size=(3, robot.nv))
    return pin.rnea(robot.model, robot.model.createData(), q, v, a)


@pytest.mark.parametrize("again", [lambda robot: pickle.loads(pickle.dumps(robot)), copy.deepcopy])
def test_a_copy_moves_alike(again):
    robot = rt.load(coupled(*random_tree(3)))
    other = again(robot)
    assert other.followers == robot.followers
    np.testing.assert_allclose(moved(other), moved(robot), rtol=1e-12, atol=1e-12)


def test_joined_robots_keep_their_couplings():
    one = rt.load(coupled(*random_tree(3)))
    both = rt.robot.join({"a": one, "b": one}, at={"b": (1.0, 0.0, 0.0)})
    assert len(both.followers) == 2 * len(one.followers)
    mimic = one.followers[0]
    assert Mimic(f"b_{mimic.follower}", f"b_{mimic.leader}", mimic.multiplier, mimic.offset) in both.followers
    again = pickle.loads(pickle.dumps(both))
    np.testing.assert_allclose(moved(again), moved(both), rtol=1e-12, atol=1e-12)


def test_a_robot_on_wheels_keeps_its_couplings():
    one = rt.load(coupled(*random_tree(3)))
    assert set(rt.robot.on_wheels(one, 20.0, 1.0).followers) == set(one.followers)
