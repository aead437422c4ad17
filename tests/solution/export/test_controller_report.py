"""Reports of controllers: jumps of the acceleration are jerks, limits are the robot's, goals have ROS's fields."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt

NODE = Path(__file__).parents[3] / "examples" / "ros" / "send_trajectory.py"
LOCKED = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}
START = np.array([0.0, -0.5, 0.0, -2.2, 0.0, 1.9, 0.8])
GOAL = {"trajectory", "path_tolerance", "goal_tolerance", "goal_time_tolerance"}
TRAJECTORY = {"header", "joint_names", "points"}
POINT = {"positions", "velocities", "accelerations", "effort", "time_from_start"}
TOLERANCE = {"name", "position", "velocity", "acceleration"}
"""Fields of FollowJointTrajectory.Goal and of its messages in control_msgs and trajectory_msgs."""


@pytest.fixture(scope="module")
def franka():
    robot = rt.load("panda", locked=LOCKED, limits=rt.robot.maker_limits("panda"))
    limits = robot.limits.scaled(0.999)
    ends = rt.State(q=START, v=0), rt.State(q=START + 0.3, v=0)
    return rt.plan(rt.Phase(robot, (0.1, 5), *ends, rt.Duration(), limits=limits))


@pytest.fixture(scope="module")
def abrupt():
    """A motion of least effort from rest to rest, whose acceleration jumps at both ends."""
    robot = rt.load("cartpole")
    ends = rt.State(q=0, v=0), rt.State(q=[0.3, 0.0], v=0)
    return rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort()), check=False)


def by_name(report):
    return {each.name: each for each in report.requirements}


def test_a_plan_within_the_makers_limits_is_accepted_and_judged_in_all(franka):
    report = rt.solution.controller_report(franka, "libfranka")
    assert report.passed and all(each.holds for each in report.requirements)
    assert set(by_name(report)) >= {"rate", "joints", "position", "speed", "acceleration", "jerk"}
    assert by_name(report)["acceleration"].bound in (7.5, 10.0, 12.5, 15.0, 20.0)
    for controller in ("joint_trajectory_controller", "fri"):
        assert rt.solution.controller_report(franka, controller).passed


def test_an_excess_that_a_proof_allows_is_named_by_a_controller_that_stops_there_alone(franka):
    """The plan uses its limits to the full; these limits are 0.05 percent below."""
    lower = franka.phases[0].phase.limits.scaled(0.9995)
    assert rt.solution.controller_report(franka, "fri", limits=lower).passed
    assert not rt.solution.controller_report(franka, "libfranka", limits=lower).passed
    beyond = lower.scaled(0.998)
    assert not rt.solution.controller_report(franka, "fri", limits=beyond).passed


def test_a_jump_of_the_acceleration_is_a_jerk_of_half_of_it_over_a_period(abrupt):
    # The second differences of a t^2 / 2 from rest are a / 2, then a.
    first = abrupt.at(0.0).a[0]
    for rate in (500.0, 1000.0):
        jerk = by_name(rt.solution.controller_report(abrupt, "joint_trajectory_controller", rate))["jerk"]
        assert jerk.holds is None
        assert jerk.figure == pytest.approx(0.5 * abs(first) * rate, rel=0.03)


def test_what_fails_is_named_with_its_figure_and_a_remedy(franka, abrupt):
    slow = by_name(rt.solution.controller_report(franka, "libfranka", 500.0))["rate"]
    assert not slow.holds and (slow.figure, slow.bound) == (500.0, 1000.0) and "rate=1000" in slow.remedy
    assert not by_name(rt.solution.controller_report(franka, "servoj"))["joints"].holds
    unknown = rt.solution.controller_report(abrupt, "libfranka")
    assert not unknown.passed and not by_name(unknown)["jerk"].holds and "no limit is known" in str(unknown)
    narrow = franka.phases[0].phase.limits.scaled(velocity=0.5)
    assert not by_name(rt.solution.controller_report(franka, "fri", limits=narrow))["speed"].holds
    with pytest.raises(rt.UnknownName, match="libfranka"):
        rt.solution.controller_report(franka, "libfrank")
    with pytest.raises(rt.InputError, match="rate"):
        rt.solution.controller_report(franka, "fri", rate=0.0)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_joint_that_may_turn_one_way_only_is_judged_by_both_of_its_limits(way):
    # A limit of 0 on one side divided rest by zero.
    pair = rt.between(0.0, 2.0) if way > 0.0 else rt.between(-2.0, 0.0)
    robot = rt.load("two_link_arm", limits={"velocity": {"shoulder": pair}, "effort": 20.0})
    ends = rt.State(q=0, v=0), rt.State(q=[0.5 * way, 0.1], v=0)
    plan = rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort()))
    accepted = by_name(rt.solution.controller_report(plan, "joint_trajectory_controller"))["speed"]
    assert accepted.holds and np.isfinite([accepted.figure, accepted.bound]).all()
    other = rt.load("two_link_arm", limits={"velocity": {"shoulder": rt.between(*sorted((0.0, -2.0 * way)))}}).limits
    refused = by_name(rt.solution.controller_report(plan, "joint_trajectory_controller", limits=other))["speed"]
    assert not refused.holds and refused.bound == 0.0 and refused.where.startswith("shoulder")
    assert refused.figure == pytest.approx(np.abs(plan.at(np.linspace(0.0, 1.0, 1001)).v[:, 0]).max(), rel=1e-2)


def test_a_motion_that_does_not_end_at_rest_is_not_accepted():
    robot = rt.load("two_link_arm")
    ends = rt.State(q=0, v=0), rt.State(q=[0.2, 0.1], v=[0.5, 0.0])
    moving = rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort(), limits=None), check=False)
    report = by_name(rt.solution.controller_report(moving, "joint_trajectory_controller"))
    rest = report["rest at the end"]
    assert not rest.holds and rest.figure == pytest.approx(0.5) and rest.where == robot.actuated[0]
    # The end is no jump to rest, which would be 0.5 rad/s in a period of 10 ms.
    fastest = np.abs(moving.at(np.linspace(0.0, 1.0, 1001)).a).max()
    assert report["acceleration"].figure < 1.1 * fastest < 0.5 / 0.01


def test_a_stop_on_a_path_replaces_a_running_motion():
    ends = rt.State(q=0.0, v=0), rt.State(q=4.0, v=0)
    plan = rt.plan(rt.Phase(rt.load("block"), (0.1, 10.0), *ends, rt.Duration()))
    report = rt.solution.controller_report(rt.stop_on_path(plan, 1.0), "joint_trajectory_controller")
    start = by_name(report)["start in motion"]
    assert report.passed and start.holds is None and start.figure == pytest.approx(1.0, rel=1e-3)
    assert "rest at the start" not in by_name(report) and by_name(report)["rest at the end"].holds


def test_a_start_whose_speed_is_left_open_must_be_at_rest():
    ends = rt.State(q=0.0), rt.State(q=4.0, v=0)
    limits = {"velocity": 2.0, "effort": 1.0}
    plan = rt.plan(rt.Phase(rt.load("block", limits=limits), (0.1, 10.0), *ends, rt.Duration()))
    report = rt.solution.controller_report(plan, "joint_trajectory_controller")
    assert not report.passed and not by_name(report)["rest at the start"].holds


def test_the_goal_for_ros_has_the_fields_of_its_messages(franka, tmp_path):
    node = runpy.run_path(str(NODE))
    message = json.loads(franka.to_controller(tmp_path / "plan.json", rate=100.0).read_text())
    goal = node["goal_of"](message)
    assert set(goal) <= GOAL and set(goal["trajectory"]) <= TRAJECTORY
    joints = goal["trajectory"]["joint_names"]
    stamps = []
    for point in goal["trajectory"]["points"]:
        assert set(point) <= POINT
        assert all(len(point[name]) == len(joints) for name in POINT - {"time_from_start"})
        stamp = point["time_from_start"]
        assert isinstance(stamp["sec"], int) and 0 <= stamp["nanosec"] < 10**9
        stamps.append(stamp["sec"] * 10**9 + stamp["nanosec"])
    assert (np.diff(stamps) > 0).all()
    assert all(set(each) <= TOLERANCE for each in goal["goal_tolerance"])
    assert [each["name"] for each in goal["goal_tolerance"]] == joints


def test_the_goal_is_sent_from_its_start_only(franka, tmp_path):
    node = runpy.run_path(str(NODE))
    message = json.loads(franka.to_controller(tmp_path / "plan.json", rate=100.0).read_text())
    joints = message["joint_names"]
    assert not node["apart"](message, [*reversed(joints)], START[::-1].tolist())
    assert list(node["apart"](message, joints, (START + [0.1, 0, 0, 0, 0, 0, 0]).tolist())) == joints[:1]
    assert list(node["apart"](message, joints[1:], START[1:].tolist())) == joints[:1]
