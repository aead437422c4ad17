"""Limits that a motion would exceed between its points are lowered there."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt


@pytest.fixture(scope="module")
def panda() -> rt.Robot:
    return rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})


@pytest.mark.parametrize("seed", [0, 5, 9])
def test_positions_stay_within_limits_that_they_touch(panda: rt.Robot, seed: int) -> None:
    lower, upper = panda.limits.position_lower, panda.limits.position_upper
    rng = np.random.default_rng(seed)
    start, end = (lower + (0.02 + 0.96 * rng.random(panda.nq)) * (upper - lower) for _ in range(2))
    # Some of these ends lie inside the robot, which does not matter here.
    phase = rt.Phase(panda, 2.5, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort(), self_collision=False)
    solution = rt.plan(phase)
    q = solution.at(np.linspace(0.0, solution.duration, 5001)).q
    excess = np.maximum(lower - q, q - upper)
    assert excess.max() > -1e-4, "the motion touches a limit"
    assert excess.max() < 1e-8


def test_an_end_beyond_a_limit_by_round_off_lowers_nothing() -> None:
    """Goals of measured joints are 3e-7 rad beyond a limit: no round of lower limits can reach them."""
    arm = rt.load("ur5")
    start, end = np.array([0.0, -1.2, 1.4, -1.5, -1.57, 0.0]), np.array([1.0, -0.9, 1.0, -1.0, -1.2, 0.0])
    limits = arm.limits.with_(position={"wrist_3_joint": 1.0})
    plans = []
    for beyond in (0.0, 3e-7):
        end[5] = 1.0 + beyond
        phase = rt.Phase(arm, (0.1, 10), rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Duration(), limits=limits)
        plans.append(rt.plan(phase))
    assert all(plan.proof.holds for plan in plans)
    assert plans[1].iterations < 1.5 * plans[0].iterations


def test_a_row_that_further_places_do_not_hold_is_lowered() -> None:
    """In least time the joints of an xarm7 oscillate: peaks of the tilt of its glass moved between the places."""
    arm = rt.load("xarm7")
    home = np.array([0.07, -0.45, 0.29, 1.12, 0.04, 1.05, 0.1])
    turn, frame = home.copy(), "link_eef"
    turn[0] += 0.4

    def pose(q: np.ndarray) -> pin.SE3:
        data = arm.model.createData()
        pin.framesForwardKinematics(arm.model, data, q)
        return pin.SE3(data.oMf[arm.frame(frame)])

    up = pose(home).rotation.T @ [0.0, 0.0, 1.0]
    glass = rt.constraints.FrameAxis(frame, axis=up, angle=np.deg2rad(2.0))
    there = rt.AtEnd(rt.FramePosition(frame, pose(turn).translation))
    plan = rt.plan(rt.Phase(arm, (0.1, 10), rt.State(q=home, v=0), rt.State(v=0), rt.Duration(), [glass, there]))
    assert plan.proof.holds
    q = plan.at(np.linspace(0.0, plan.duration, 3001)).q
    tilt = [np.degrees(np.arccos(min((pose(each).rotation @ up)[2], 1.0))) for each in q]
    assert max(tilt) < 2.0 * (1 + 1e-3)
