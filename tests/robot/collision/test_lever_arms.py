"""Bounds on the speeds of points, on the rates of their distances, and on their distances from other axes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.collision.lever_arms import joints_of_rates, levers, levers_across, relative_levers
from robotraj.robot.collision.own_body import own_body
from robotraj.robot.collision.placements import joint_tree, placements
from robotraj.robot.coupling.coupled_model import coupled
from tests.robot.coupling.random_trees import random_tree


@pytest.mark.parametrize("seed", range(8))
def test_points_and_distances_change_no_faster_than_the_bounds(seed):
    robot = rt.load(coupled(*random_tree(seed)))
    rng = np.random.default_rng(seed)
    joints, points = rng.integers(1, robot.model.njoints, 12), rng.uniform(-0.3, 0.3, (12, 3))
    first, second = rng.integers(0, 12, (2, 30))
    single, pairs = levers(robot, joints, points), relative_levers(robot, joints, points, first, second)
    q = rng.uniform(*robot.limits.positions, (40, robot.nq))
    v = rng.normal(size=(40, robot.nv))
    step = 1e-6

    def places(at):
        rotations, origins = placements(robot, at)
        return np.einsum("mkij,kj->mki", rotations[:, joints], points) + origins[:, joints]

    here, there = places(q), places(q + step * v)
    speeds = np.linalg.norm(there - here, axis=2) / step
    assert np.all(speeds <= np.abs(v) @ single.T + 1e-5)
    apart = [np.linalg.norm(each[:, first] - each[:, second], axis=2) for each in (here, there)]
    assert np.all(np.abs(apart[1] - apart[0]) / step <= np.abs(v) @ pairs.T + 1e-5)


@pytest.mark.parametrize("seed", range(4))
def test_placements_are_pinocchios(seed):
    robot = rt.load(coupled(*random_tree(seed)))
    q = np.random.default_rng(seed).normal(size=(3, robot.nq))
    rotations, origins = placements(robot, q)
    data = robot.model.createData()
    for k, each in enumerate(q):
        pin.forwardKinematics(robot.model, data, each)
        for i in range(1, robot.model.njoints):
            np.testing.assert_allclose(rotations[k, i], data.oMi[i].rotation, atol=1e-12)
            np.testing.assert_allclose(origins[k, i], data.oMi[i].translation, atol=1e-12)


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_points_are_no_further_from_the_axes_of_other_joints_than_the_bounds(name: str) -> None:
    robot, rng = rt.load(name), np.random.default_rng(2)
    body, tree = own_body(robot), joint_tree(robot)
    bounds, moved = levers_across(robot, body.joint, body.farthest), tree.is_carried_by()
    limits, rates = robot.limits, joints_of_rates(robot)
    for _ in range(5):
        q = rng.uniform(limits.position_lower, limits.position_upper)
        rotations, origins = (each[0] for each in placements(robot, q[None]))
        for shape, (joint, point) in enumerate(zip(body.joint.tolist(), body.farthest, strict=True)):
            place = rotations[joint] @ point + origins[joint]
            for j in np.flatnonzero(tree.turns & ~moved[joint]).tolist():
                axis = rotations[j] @ tree.axes[j]
                away = np.linalg.norm(np.cross(place - origins[j], axis))
                assert away <= bounds[shape, int(np.searchsorted(rates, j))] + 1e-12
