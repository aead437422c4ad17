"""Contacts stand where the ground lets them: on its height, and with their whole sole on one tread."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt

STEPS = rt.Steps.stairs(0.3, 0.35, 0.15, 3, 0.03)


def stands(xs: np.ndarray) -> bool:
    """Whether points at these x lie on one tread."""
    return any(low <= xs.min() and xs.max() <= high for low, high, _ in STEPS.treads)


def rows(robot: rt.Robot, contact: Any, **anchors: float) -> list[float]:
    bound = contact.bind(robot)
    names = {anchor.name: anchors[anchor.name.split(".")[1]] for anchor in bound.anchors}
    values = [float(value) for value in bound.footing(names)]
    assert len(values) == len(bound.footing_rows) == 3
    return values


@pytest.mark.parametrize("kind", ["foot", "edge", "point"])
def test_a_sole_on_stairs_lies_on_one_tread(kind: str) -> None:
    robot = rt.load("bolt", root="floating")
    contact, corners = {
        "foot": (
            rt.FlatFoot("FL_FOOT", (0.05, 0.15), 0.1, ground=STEPS),
            [[-0.05, -0.05], [-0.05, 0.05], [0.15, -0.05], [0.15, 0.05]],
        ),
        "edge": (rt.LineContact("FL_FOOT", 0.1, ground=STEPS), [[0.0, -0.05], [0.0, 0.05]]),
        "point": (rt.PointContact("FL_FOOT", ground=STEPS), [[0.0, 0.0]]),
    }[kind]
    random, allowed = np.random.default_rng(2), 0
    for _ in range(400):
        x, yaw = random.uniform(-0.3, 1.5), random.uniform(-0.8, 0.8)
        along = np.array(corners) @ [np.cos(yaw), -np.sin(yaw)]
        if min(rows(robot, contact, x=x, y=0.2, yaw=yaw)) >= 0.0:
            allowed += 1
            assert stands(x + along)
        else:
            assert not stands(x + np.array([along.min() - 2e-3, along.max() + 2e-3]))
    assert 80 < allowed < 380


def test_in_a_plane_heel_and_toe_stand_on_one_tread() -> None:
    robot = rt.load("hopper", root="planar")
    foot = rt.FlatFoot("foot", (0.05, 0.15), ground=STEPS)
    for x in np.linspace(-0.3, 1.5, 500):
        assert (min(rows(robot, foot, x=x)) >= 0.0) == stands(np.array([x - 0.05, x + 0.15]))
