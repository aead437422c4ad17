"""Limits of jerks and torque rates hold across the ends: motions from rest to rest against closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

ENDS = (1.0, -0.4, 0.2, 0.7, -0.9, 0.3, 0.05)


def axes(folder: Path, count: int, speed: float, acceleration: float, jerk: float) -> rt.Robot:
    """Return sliders of 1 kg on one rail, each with its own limits."""
    inertia = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
    parts = ['<link name="l0"/>']
    for k in range(1, count + 1):
        parts.append(
            f'<link name="l{k}"><inertial><mass value="1"/>{inertia}</inertial></link>'
            f'<joint name="j{k}" type="prismatic"><parent link="l{k - 1}"/><child link="l{k}"/><axis xyz="1 0 0"/>'
            f'<limit lower="-20" upper="20" velocity="{speed}" effort="1e6"/></joint>'
        )
    path = folder / "axes.urdf"
    path.write_text(f'<robot name="axes">{"".join(parts)}</robot>')
    return rt.load(path, limits={"acceleration": acceleration, "jerk": jerk})


def least_time(distance: float, speed: float, acceleration: float, jerk: float) -> float:
    """Return the time of the motion of seven segments that reaches both other limits: L / v + v / a + a / j."""
    assert acceleration**2 / jerk < speed and distance > speed * (speed / acceleration + acceleration / jerk)
    return distance / speed + speed / acceleration + acceleration / jerk


@pytest.mark.parametrize("count", [1, 3, 7])
def test_axes_from_rest_to_rest_take_the_time_of_seven_segments(tmp_path: Path, count: int) -> None:
    """The longest axis takes 1 / 1.5 + 1.5 / 5 + 5 / 50 s, and the others wait for it."""
    robot = axes(tmp_path, count, 1.5, 5.0, 50.0)
    move = rt.Phase(robot, (0.05, 10.0), rt.State(q=[0.0] * count, v=0), rt.State(q=ENDS[:count], v=0), rt.Duration())
    solution = rt.plan(move)
    assert solution.duration == pytest.approx(least_time(1.0, 1.5, 5.0, 50.0), rel=1e-4)
    for t in (0.0, solution.duration):
        np.testing.assert_allclose(solution.at(t).a, 0.0, atol=1e-9)
    times = np.linspace(0.0, solution.duration, 4001)
    jerks = np.diff(solution.at(times).a, axis=0) / np.diff(times)[:, None]
    assert np.abs(jerks).max() < 50.0 * (1 + 1e-6)
    assert rt.validate(solution).passed


def test_a_path_from_rest_to_rest_takes_the_same_time(tmp_path: Path) -> None:
    robot = axes(tmp_path, 3, 1.5, 5.0, 50.0)
    solution = rt.retime(np.array([np.zeros(3), ENDS[:3]]), robot)
    assert solution.duration == pytest.approx(least_time(1.0, 1.5, 5.0, 50.0), rel=2e-4)
    np.testing.assert_allclose(solution.at(np.array([0.0, solution.duration])).a, 0.0, atol=1e-6)


def test_a_path_that_begins_at_speed_may_begin_with_an_acceleration(tmp_path: Path) -> None:
    robot = axes(tmp_path, 1, 1.5, 5.0, 50.0)
    moving = rt.retime(np.array([[0.0], [1.0]]), robot, start_speed=0.5)
    assert moving.at(0.0).a[0] > 1.0


def test_a_measured_start_states_its_acceleration(tmp_path: Path) -> None:
    """From v0 and a0 > 0 the speed reaches its limit without a limit of acceleration in (v - v0, a0) by two ramps."""
    robot = axes(tmp_path, 1, 1.0, 1e3, 20.0)
    start, speed, acceleration, jerk = 0.4, 1.0, 2.0, 20.0
    move = rt.Phase(
        robot, (0.05, 10.0), rt.State(q=[0.0], v=start, a=acceleration), rt.State(q=[2.0], v=0), rt.Duration()
    )
    solution = rt.plan(move)
    assert solution.at(0.0).a[0] == pytest.approx(acceleration, abs=1e-4)
    # Up: a0 to p at +j, p to 0 at -j with (2 p^2 - a0^2) / (2 j) = v - v0. Down: two ramps of sqrt(v / j).
    peak = np.sqrt(jerk * (speed - start) + 0.5 * acceleration**2)
    first, second = (peak - acceleration) / jerk, peak / jerk
    gained = start * first + acceleration * first**2 / 2 + jerk * first**3 / 6
    middle = start + acceleration * first + jerk * first**2 / 2
    gained += middle * second + peak * second**2 / 2 - jerk * second**3 / 6
    down = 2.0 * np.sqrt(speed / jerk)
    exact = first + second + (2.0 - gained - speed * down / 2) / speed + down
    assert solution.duration == pytest.approx(exact, rel=1e-4)


def test_a_start_at_speed_without_an_acceleration_leaves_it_free(tmp_path: Path) -> None:
    robot = axes(tmp_path, 1, 1.0, 5.0, 20.0)
    free, still = (
        rt.plan(rt.Phase(robot, (0.05, 9.0), rt.State(q=[0.0], v=0.3, a=a), rt.State(q=[1.0], v=0), rt.Duration()))
        for a in (None, 0.0)
    )
    assert free.at(0.0).a[0] > 1.0 > abs(still.at(0.0).a[0]) and free.duration < still.duration


def test_a_limited_torque_begins_with_the_one_that_holds_the_arm() -> None:
    """Gravity loads both joints; only the torque rate of the first is limited, and the second may accelerate."""
    arm = rt.load("two_link_arm")
    first = arm.actuated[0]
    rate = rt.constraints.JointTorqueRate({first: 40.0})
    start = np.array([0.3, 0.4])
    move = rt.Phase(arm, (0.2, 8.0), rt.State(q=start, v=0), rt.State(q=start + 0.5, v=0), rt.Duration(), [rate])
    solution = rt.plan(move)
    held = arm.model.createData()
    gravity = pin.computeGeneralizedGravity(arm.model, held, start)
    assert solution.at(0.0).tau[0] == pytest.approx(gravity[0], abs=1e-3)
    assert abs(solution.at(0.0).a[1]) > 1e-2
    assert rt.validate(solution).passed


def test_phases_share_their_rows_only_between_ends_of_one_kind(tmp_path: Path) -> None:
    robot = axes(tmp_path, 1, 1.0, 5.0, 20.0)
    move = rt.Phase(robot, (0.05, 9.0), rt.State(q=[0.0], v=0), rt.State(q=[1.0], v=0), rt.Duration())
    rows = move.rows
    assert move.with_(start=rt.State(q=[0.1], v=0)).rows is rows
    assert move.with_(start=rt.State(q=[0.1], v=0.2)).rows is not rows
    assert move.with_(start=rt.State(q=[0.1], v=0.2, a=1.0)).rows is not rows


def test_accelerations_belong_to_robots_off_paths(tmp_path: Path) -> None:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    with pytest.raises(rt.InputError, match="q=, v= and a= are for robots"):
        rt.Phase(block, 1.0, rt.State(a=1.0))
    robot = axes(tmp_path, 1, 1.0, 5.0, 20.0)
    follow = rt.constraints.FollowPath(rt.applications.as_path(np.array([[0.0], [1.0]])))
    with pytest.raises(rt.InputError, match="leave start= out"):
        rt.Phase(robot, (0.0, 9.0), rt.State(a=1.0), constraints=[follow])
