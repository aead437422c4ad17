"""Axes of joints in trees where joints follow others."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.coupling.dynamics import joint_axes
from tests.robot.coupling.random_trees import random_tree


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_the_axis_of_a_joint_is_the_rate_of_its_placement_on_its_parent(seed: int, floating: bool) -> None:
    model, mimics = random_tree(seed, floating=floating)
    model = coupled(model, mimics)
    assert len(model.mimicking_joints)
    rng, h = np.random.default_rng(seed), 1e-6
    q = pin.integrate(model, pin.neutral(model), 0.5 * rng.normal(size=model.nv))
    data = model.createData()
    axes = joint_axes(model, data, q)
    assert axes.shape == (6, model.nv)
    pin.forwardKinematics(model, data, q)
    for joint in range(2 if floating else 1, model.njoints):
        column = model.joints[joint].idx_v
        if not model.joints[joint].nv:
            continue  # it follows another
        ends = []
        for sign in (-1.0, 1.0):
            moved = model.createData()
            pin.forwardKinematics(model, moved, pin.integrate(model, q, sign * h * np.eye(model.nv)[column]))
            ends.append(moved.oMi[model.parents[joint]].actInv(moved.oMi[joint]))
        rate = pin.log6(ends[0].actInv(ends[1])).vector / (2.0 * h)
        here = data.oMi[joint].actInv(pin.Motion(axes[:, column])).vector
        np.testing.assert_allclose(here, rate, atol=1e-7)
