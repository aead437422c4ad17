"""Rows at the ends of phases, and how easily they give."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

import robotraj as rt


def place(arm: rt.Robot, q: Sequence[float]) -> pin.SE3:
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, np.array(q, dtype=float))
    return data.oMf[arm.frame("panda_hand_tcp")]


def test_a_cone_gives_way_before_the_pose_that_contradicts_it() -> None:
    arm = rt.load("panda")
    start, end = [0, -0.5, 0, -2, 0, 1.5, 0.8], [0.5, 0.2, 0, -1.2, 0.5, 2.5, 0.8]
    upright, goal = (place(arm, q) for q in (start, end))
    cone = rt.constraints.FrameAxis("panda_hand_tcp", (0, 0, 1), tuple(upright.rotation[:, 2]), 0.1)
    pose = rt.AtEnd(rt.FramePose("panda_hand_tcp", (goal.translation, goal.rotation)))
    phase = rt.Phase(arm, 2.0, rt.State(q=start, v=0), rt.State(v=0), rt.Effort(), [cone, pose])
    failed = rt.plan(phase, check=False)
    (conflict,) = failed.conflicts
    assert conflict.name == "frame axis angle, panda_hand_tcp" and "frame orientation" in conflict.reason


def test_a_system_without_inputs_names_the_duration_that_it_lacks() -> None:
    """It has neither controls nor algebraic variables, and the search for its rows raised an error of CasADi."""
    growth = rt.System(["x"], [], lambda point: [point.x["x"]])
    failed = rt.plan(rt.Phase(growth, (0.1, 1.0), rt.State([1.0]), rt.State([3.0])), check=False)  # ln 3 = 1.1 s
    assert not failed.success
    assert [conflict.name for conflict in failed.conflicts] == ["duration"]
