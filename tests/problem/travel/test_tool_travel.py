"""Speeds of a frame against the way between its places, where the bound is |p_1 - p_0| / V."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.problem.travel.tool_travel import greatest_speed

HOME = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


def place(robot: rt.Robot, q: np.ndarray) -> np.ndarray:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return np.array(data.oMf[robot.frame("tool0")].translation)


def move(robot: rt.Robot, duration: float, linear: float, *constraints: object, free: bool = False) -> rt.Phase:
    end = rt.State(v=0) if free else rt.State(q=HOME + [1.0, 0, 0, 0, 0, 0], v=0)
    limit = rt.constraints.FrameSpeed("tool0", linear=linear)
    return rt.Phase(robot, duration, rt.State(q=HOME, v=0), end, rt.Effort(), [limit, *constraints])


def test_the_named_duration_is_the_way_over_the_speed(ur5: rt.Robot) -> None:
    way = float(np.linalg.norm(place(ur5, HOME) - place(ur5, HOME + [1.0, 0, 0, 0, 0, 0])))
    with pytest.raises(rt.InputError, match=rf"must travel {way:.4g} m.* than {way / 0.1:.4g} s.* above {way:.4g} m/s"):
        move(ur5, 1.0, 0.1)
    assert move(ur5, 1.001 * way / 0.1, 0.1)


def test_a_place_given_by_rows_counts_as_one_of_joints_does(ur5: rt.Robot) -> None:
    goal = rt.AtEnd(rt.FramePosition("tool0", place(ur5, HOME) + [0.0, 0.3, 0.0]))
    with pytest.raises(rt.InputError, match="must travel 0.3 m"):
        move(ur5, 2.0, 0.1, goal, free=True)
    assert move(ur5, 2.0, 0.1, free=True)


def test_no_drawn_motion_of_the_joints_is_faster_than_the_bound(ur5: rt.Robot) -> None:
    rng = np.random.default_rng(0)
    data, most = ur5.model.createData(), 0.0
    for _ in range(300):
        q, v = rng.uniform(-np.pi, np.pi, 6), rng.choice([-1, 1], 6) * ur5.limits.velocity
        pin.forwardKinematics(ur5.model, data, q, v)
        pin.updateFramePlacements(ur5.model, data)
        speed = pin.getFrameVelocity(ur5.model, data, ur5.frame("tool0"), pin.LOCAL_WORLD_ALIGNED).linear
        most = max(most, float(np.linalg.norm(speed)))
    assert 0.2 * greatest_speed(ur5) < most < greatest_speed(ur5)


def test_a_speed_in_mm_per_second_is_doubted(ur5: rt.Robot) -> None:
    with pytest.warns(UserWarning, match=r"250 m/s of frame 'tool0' has no effect.* 250 mm/s are 0.25 m/s"):
        move(ur5, 2.0, 250.0)
