"""Poses are read from every usual form, and lengths that can only be millimetres are refused."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

UR5 = rt.load("ur5")
PLACE = pin.SE3(pin.exp3(np.array([0.3, -1.0, 0.5])), np.array([0.4, 0.2, 0.3]))


def ending_at(constraint: rt.constraints.Constraint, robot: rt.robot.Robot = UR5) -> rt.Phase:
    end = rt.State(v=0) if robot.root == "fixed" else rt.State()
    return rt.Phase(robot, 2.0, rt.State(v=0), end, rt.Effort(), [rt.AtEnd(constraint)])


def test_a_homogeneous_matrix_is_the_pose_of_its_parts() -> None:
    given = PLACE.homogeneous
    constraint = rt.FramePose("tool0", given)
    assert isinstance(constraint.pose, pin.SE3) and constraint.pose.isApprox(PLACE)
    given[0, 3] = 9.0  # the caller's array is copied
    assert constraint.pose.isApprox(PLACE)
    both = ending_at(constraint).rows, ending_at(rt.FramePose("tool0", PLACE)).rows
    one, other = ([(row.lower, row.upper) for row in rows] for rows in both)
    assert one == other


def test_a_matrix_that_is_no_pose_is_refused_with_the_reason() -> None:
    with pytest.raises(rt.InputError, match=r"last row .* \[0.0, 0.0, 0.0, 2.0\]; it must be \[0, 0, 0, 1\]"):
        rt.FramePose("tool0", np.diag([1.0, 1.0, 1.0, 2.0]))
    with pytest.raises(rt.InputError, match="not a rotation"):
        rt.FramePose("tool0", np.diag([2.0, 1.0, 1.0, 1.0]))
    with pytest.raises(rt.InputError, match=r"matrix \(4, 4\)"):
        ending_at(rt.FramePose("tool0", np.eye(3)))  # type: ignore[arg-type]  # what is tested


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_millimetres_are_refused_before_the_solve(sign: float) -> None:
    message = rf"x = {400 * sign:g} m, but 'ur5' reaches .* {400 * sign:g} mm are {0.4 * sign:g}"
    with pytest.raises(rt.InputError, match=message):
        ending_at(rt.FramePosition("tool0", (400.0 * sign, 200.0, 300.0)))
    with pytest.raises(rt.InputError, match="Lengths are in metres"):
        ending_at(rt.FramePose("tool0", (np.array([400.0 * sign, 200.0, 300.0]), np.eye(3))))


def test_far_places_are_no_millimetres_where_the_root_or_a_rail_moves() -> None:
    ending_at(rt.FramePosition("tool0", (rt.between(-400, 400), None, 0.3)))
    ending_at(rt.FramePosition("foot", {"x": 400.0}), rt.load("hopper", root="planar"))
    far = rt.load("ur5", base=((300.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
    ending_at(rt.FramePosition("tool0", (300.4, 0.2, 0.3)), far)
