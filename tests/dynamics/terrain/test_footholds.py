"""Contacts satisfy the ground's constraints: they are at its height, with their whole sole on one tread."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt

STEPS = rt.terrain.Steps.stairs(0.3, 0.35, 0.15, 3, 0.03)


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
        "edge": (rt.contacts.LineContact("FL_FOOT", 0.1, ground=STEPS), [[0.0, -0.05], [0.0, 0.05]]),
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


def test_a_planned_foothold_stays_off_the_riser() -> None:
    robot = rt.load("hopper", root="planar")
    steps = rt.terrain.Steps([0.02], [0.0, 0.2], 0.03)
    phase = rt.Phase(
        robot,
        0.6,
        rt.State(q={"root_pitch": 0.0, "hip": 0.1, "leg": 0.4}, v=0),
        rt.State(q={"root_pitch": 0.1, "hip": -0.1, "leg": 0.6}),
        rt.Effort(),
        contacts=[rt.PointContact("foot", ground=steps)],
        parameters={"foot.x": rt.between(0.0, 0.1)},
    )
    # From the middle of its range: the guess for legs would put the foot on the riser, at the end of the range.
    solution = rt.plan(phase, rt.Mesh(8), rt.guess.StraightLine())
    x = solution.phases[0].parameters["foot.x"]
    assert steps.footing(x, 0.0)[0] >= -1e-8
    assert steps.height(x, 0.0) == pytest.approx(0.2, abs=1e-12)


def test_a_swing_foot_measures_its_progress_from_a_foothold() -> None:
    robot = rt.load("five_link", root="planar")
    swing = rt.GroundClearance(
        "right_foot", rt.constraints.SwingApex(0.05, lambda point: point.p["left_foot.x"] - 0.3, 0.3)
    )
    named = rt.GroundClearance("right_foot", rt.constraints.SwingApex(0.05, -0.3, "left_foot.x"))
    stance = rt.PointContact("left_foot")
    phase = rt.Phase(robot, 0.7, constraints=[swing, named], contacts=[stance])
    labels = [row.label for bound in phase.bound_constraints for row in bound.rows]
    assert labels.count("swing apex, right_foot") == 2
    with pytest.raises(rt.UnknownName, match="right_foot.x.*left_foot.x"):
        wrong = rt.GroundClearance("right_foot", rt.constraints.SwingApex(0.05, -0.3, "right_foot.x"))
        rt.Phase(robot, 0.7, constraints=[wrong], contacts=[stance]).bound_constraints  # noqa: B018
