"""Constraints hold at their times, on plans that would violate them otherwise."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt


def swing(*constraints: Any, **more: Any) -> rt.Phase:
    given = {
        "duration": 2.0,
        "start": rt.State(q=[0, 0], v=0),
        "end": rt.State(q=[1, np.pi], v=0),
        "objective": rt.Effort(),
    }
    return rt.Phase(rt.load("cartpole"), constraints=constraints, **(given | more))


def arm(*constraints: Any, **more: Any) -> rt.Phase:
    limits = rt.load("two_link_arm").limits.with_(effort=50.0)
    given = {
        "duration": 2.0,
        "start": rt.State(q=[0, 0.5], v=0),
        "end": rt.State(q=[0.8, -0.5], v=0),
        "objective": rt.Effort(),
    }
    return rt.Phase(rt.load("two_link_arm"), constraints=constraints, limits=limits, **(given | more))


def tip(robot: rt.Robot, q: np.ndarray) -> pin.SE3:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame("tip")].copy()


@pytest.mark.parametrize(
    ("constraint", "read"),
    [
        (rt.constraints.JointPosition({"slider": rt.between(None, 1.05)}), lambda s: s.q[:, 0] - 1.05),
        (
            rt.constraints.JointVelocity({"pole": rt.between(-9, 6)}),
            lambda s: np.maximum(s.v[:, 1] - 6, -9 - s.v[:, 1]),
        ),
        (rt.constraints.JointAcceleration({"slider": rt.between(-9, 9)}), lambda s: np.abs(s.a[:, 0]) - 9),
        (rt.constraints.JointEffort(rt.between(-11, 11)), lambda s: np.abs(s.tau[:, 0]) - 11),
        (
            rt.PathConstraint(lambda point: point.tau[0] * point.v[0], lower=-12, upper=12),
            lambda s: np.abs(s.tau[:, 0] * s.v[:, 0]) - 12,
        ),
    ],
    ids=["position", "velocity", "acceleration", "effort", "power"],
)
@pytest.mark.parametrize(
    "form", [rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()], ids=["inverse", "forward"]
)
def test_a_bound_that_was_broken_is_held_and_touched(constraint: Any, read: Any, form: Any) -> None:
    free = rt.plan(swing(dynamics=form), rt.Mesh(30))
    held = rt.plan(swing(constraint, dynamics=form), rt.Mesh(30), guess=free)
    points = held.phases[0].points
    assert np.max(read(free.at(points))) > 1e-2
    assert -2e-2 < np.max(read(held.at(points))) < 1e-5
    assert held.objective > free.objective


def test_clearance_keeps_the_tip_above_a_slope_and_a_bump() -> None:
    robot = rt.load("acrobot")
    start, end = rt.State(q=[1.8, 0], v=0), rt.State(q=[-1.8, 0], v=0)
    base = tip(robot, np.zeros(2)).translation[2]
    for ground in (
        rt.terrain.Flat(base + 0.3),
        rt.terrain.Slope(0.2, 0.0, base + 0.3),
        lambda x, y: base + 0.4 * ca.exp(-4 * x**2),
    ):
        held = rt.Phase(robot, 1.5, start, end, rt.Effort(), [rt.GroundClearance("tip", 0.05, ground)], limits=None)
        free = rt.Phase(robot, 1.5, start, end, rt.Effort(), limits=None)
        height = ground if callable(ground) else ground.height

        def least(solution: rt.Solution, height: Any = height) -> float:
            poses = [tip(robot, q).translation for q in solution.at(solution.phases[0].points).q]
            return min(float(p[2] - height(p[0], p[1])) for p in poses)

        # The path below the shoulder, which only the ground forbids, is one of several optima; IPOPT finds it.
        assert least(rt.plan(free, rt.Mesh(), solver=rt.Ipopt())) < 0.0
        assert least(rt.plan(held, rt.Mesh(), solver=rt.Ipopt())) >= 0.05 - 1e-6


def test_frame_position_holds_at_the_end_alone() -> None:
    robot = rt.load("two_link_arm")
    goal = tip(robot, np.array([0.6, 0.9])).translation
    reach = rt.AtEnd(rt.FramePosition("tip", [goal[0], goal[1], None]))
    solution = rt.plan(arm(reach, end=rt.State(v=0)))
    np.testing.assert_allclose(tip(robot, solution.at(2.0).q).translation[:2], goal[:2], atol=1e-6)
    assert np.linalg.norm(tip(robot, solution.at(1.0).q).translation - goal) > 0.05


def test_frame_position_may_be_an_interval_of_one_axis() -> None:
    robot = rt.load("two_link_arm")
    solution = rt.plan(arm(rt.FramePosition("tip", {"x": rt.between(None, 1.99)}), end=rt.State(q=[0.8, -0.5], v=0)))
    xs = [tip(robot, q).translation[0] for q in solution.at(solution.phases[0].points).q]
    assert max(xs) <= 1.99 + 1e-6


@pytest.mark.parametrize("write", ["SE3", "matrix", "quaternion", "coefficients"])
def test_frame_pose_is_reached_however_it_is_written(write: str) -> None:
    robot = rt.load("ur5")
    goal_q = np.array([0.4, -1.2, 1.1, -0.5, -1.2, 0.3])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, goal_q)
    frame = robot.frame("tool0")
    goal = data.oMf[frame].copy()
    pose = {
        "SE3": goal,
        "matrix": (goal.translation, goal.rotation),
        "quaternion": (goal.translation, pin.Quaternion(goal.rotation)),
        "coefficients": (goal.translation, list(pin.Quaternion(goal.rotation).coeffs())),
    }[write]
    start = rt.State(q=[0, -1.4, 1.3, -0.8, -1.4, 0], v=0)
    reach = rt.AtEnd(rt.FramePose("tool0", pose))
    phase = rt.Phase(robot, 2.0, start, rt.State(v=0), rt.Effort(), [reach])
    solution = rt.plan(phase, rt.Mesh(10))
    pin.framesForwardKinematics(robot.model, data, solution.at(2.0).q)
    assert np.linalg.norm(pin.log6(goal.actInv(data.oMf[frame])).vector) < 1e-5


def test_a_constraint_at_the_start_does_not_apply_later() -> None:
    quiet = rt.AtStart(rt.constraints.JointEffort(rt.between(0, 0)))
    solution = rt.plan(swing(quiet))
    assert solution.at(0.0).tau[0] == pytest.approx(0, abs=1e-7)
    assert abs(solution.at(0.3).tau[0]) > 1


def test_a_path_constraint_of_many_rows_numbers_them() -> None:
    both = rt.PathConstraint(lambda point: [point.v[0], point.v[1]], lower=[-9, -20], upper=20, name="speeds")
    names = [
        row.name for constraint in swing(both).bound_constraints for row in constraint.rows if "speeds" in row.name
    ]
    assert names == ["speeds[0]", "speeds[1]"]


def test_rows_of_a_robot_by_forward_dynamics_are_added_between_points_too() -> None:
    """Its accelerations are expressions of the torques; a row on them is none of the state alone."""
    rows = [rt.GroundClearance("tip", -0.7), rt.constraints.JointAcceleration({"slider": rt.between(-50, 50)})]
    assert rt.plan(swing(*rows, dynamics=rt.dynamics.ForwardDynamics()), rt.Mesh(20)).success
    still = rt.System(["x"], [], lambda point: [1.0])
    low = rt.PathConstraint(lambda point: point.x["x"] ** 2, upper=2)
    assert rt.plan(rt.Phase(still, 1.0, rt.State([0]), constraints=[low]), rt.Mesh(2)).success
