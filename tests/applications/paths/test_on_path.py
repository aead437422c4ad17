"""Speed override and stops on the path: closed forms, the path is kept, the motion is left where it was."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

A = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
B = A + [1.4, 0.5, -0.5, 0.3, 0.4, 0.5]


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur5")


@pytest.fixture(scope="module")
def quick(arm):
    return rt.plan(rt.Phase(arm, (0.1, 10.0), rt.State(q=A, v=0), rt.State(q=B, v=0), rt.Duration()))


@pytest.fixture(scope="module")
def block():
    """1 kg and 1 N over 4 m: 2 s of acceleration, 2 s of deceleration, 2 m/s in the middle."""
    ends = rt.State(q=0.0, v=0), rt.State(q=4.0, v=0)
    return rt.plan(rt.Phase(rt.load("block"), (0.1, 10.0), *ends, rt.Duration()))


@pytest.mark.parametrize("speed", [0.1, 0.5, 1.0])
def test_a_share_of_the_speed_is_the_same_motion_in_stretched_time(quick, speed):
    slow = rt.override(quick, speed)
    assert slow.proof.holds and slow.duration == pytest.approx(quick.duration / speed, rel=1e-4)
    shares = np.linspace(0.0, 1.0, 101)
    known, found = quick.at(shares * quick.duration), slow.at(shares * slow.duration)
    assert np.abs(found.q - known.q).max() < 1e-4
    assert np.abs(found.v - speed * known.v)[1:-1].max() < 1e-2 * speed
    assert np.abs(found.v[[0, -1]]).max() < 1e-9


@pytest.mark.slow
def test_torques_of_an_override_are_those_of_inverse_dynamics_at_its_speed(quick):
    """tau = g(q) + speed^2 (tau_plan - g(q)), since the model has no friction."""
    slow = rt.override(quick, 0.5)
    shares = np.linspace(0.05, 0.95, 50)
    known, found = quick.at(shares * quick.duration), slow.at(shares * slow.duration)
    model, data = quick.phases[0].phase.robot.model, quick.phases[0].phase.robot.model.createData()
    held = np.array([pin.computeGeneralizedGravity(model, data, q) for q in known.q])
    # Torques of least time jump, at times that agree to the step of the mesh.
    far = np.abs(found.tau - (held + 0.25 * (known.tau - held)))
    assert np.quantile(far, 0.9) < 0.5
    assert rt.validate(slow).passed


def test_a_block_stops_with_its_whole_force(block):
    """From rest, 1 s of 1 m/s^2 gives 1 m/s, and a stop takes 1 s and 0.5 m; after the middle nothing is earlier."""
    early = rt.stop_on_path(block, 1.0)
    assert early.duration == pytest.approx(1.0, rel=2e-3)
    assert early.at(early.duration).q[0] == pytest.approx(1.0, rel=2e-3)
    late = rt.stop_on_path(block, 3.0)
    assert late.duration == pytest.approx(1.0, rel=2e-3) and late.at(late.duration).q[0] == pytest.approx(4.0, abs=1e-3)


@pytest.mark.parametrize("share", [0.05, 0.5, 0.99])
def test_a_stop_begins_in_the_plan_and_ends_at_rest_on_its_path(quick, share):
    time = share * quick.duration
    stop = rt.stop_on_path(quick, time)
    assert stop.proof.holds and rt.validate(stop).passed
    first, last, known = stop.at(0.0), stop.at(stop.duration), quick.at(time)
    assert np.allclose(first.q, known.q, atol=1e-9) and np.allclose(first.v, known.v, atol=1e-7)
    assert np.abs(last.v).max() < 1e-7
    assert stop.duration < (quick.duration - time) * (1.0 + 1e-3)
    path = quick.at(np.linspace(0.0, quick.duration, 20001)).q
    passed = stop.at(np.linspace(0.0, stop.duration, 50)).q
    assert np.abs(passed[:, None] - path[None]).max(axis=2).min(axis=1).max() < 1e-3


@pytest.mark.slow
def test_under_a_limit_of_jerk_the_acceleration_is_continuous_into_the_stop(arm):
    way = np.array([A, A + [0.4, 0.3, -0.2, 0, 0, 0.5], A + [0.9, 0.2, 0.1, 0.4, 0, 0.2]])
    gentle = rt.retime(way, arm, jerk=500.0)
    time = 0.3 * gentle.duration
    stop = rt.stop_on_path(gentle, time)
    at = gentle.at(time).a
    assert np.allclose(stop.at(0.0).a, at, atol=1e-6 * np.abs(at).max())
    t = np.linspace(0.0, stop.duration, 2001)
    assert np.abs(np.diff(stop.at(t).a, axis=0) / np.diff(t)[:, None]).max() < 500.0 * (1 + 3e-3)
    assert rt.validate(stop).passed


@pytest.mark.slow
def test_constraints_on_speeds_hold_at_lower_speed_and_those_on_positions_are_the_path(arm):
    """The limit of the tool's speed is active; at half of the speed it is half used."""
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, A)
    up = data.oMf[arm.frame("tool0")].rotation.T @ [0, 0, 1]
    rows = [rt.constraints.FrameSpeed("tool0", linear=0.5), rt.constraints.FrameAxis("tool0", axis=up, angle=0.2)]
    plan = rt.plan(
        rt.Phase(
            arm,
            (0.1, 10.0),
            rt.State(q=A, v=0),
            rt.State(q=A + [1.4, 0, 0, 0, 0, 0], v=0),
            rt.Duration() + 1e-3 * rt.objectives.SpeedVariation(),
            rows,
        )
    )
    slow = rt.override(plan, 0.5)
    assert [type(each).__name__ for each in slow.problem.phases[0].constraints] == ["FollowPath", "FrameSpeed"]
    assert slow.duration == pytest.approx(2.0 * plan.duration, rel=1e-3)
    assert rt.validate(slow).passed


def test_a_dwell_and_phases_are_kept():
    waiting = rt.plan(rt.Waypoints(rt.load("block"), [[0.0], [1.0], [0.0]], dwell={1: 0.5}))
    slow = rt.override(waiting, 0.5)
    assert len(slow.phases) == 3 and slow.duration == pytest.approx(2.0 * waiting.duration, rel=2e-3)
    assert slow.phases[1].duration == pytest.approx(1.0, rel=1e-3)


def test_a_stop_before_a_dwell_ends_at_the_dwell_at_the_latest():
    """Joints that do not move leave the place on the path open; what follows the dwell is no part of the stop."""
    waiting = rt.plan(rt.Waypoints(rt.load("block"), [[0.0], [1.0], [0.0]], dwell={1: 0.5}))
    first = waiting.phases[0].duration
    late = rt.stop_on_path(waiting, 0.75 * first)
    assert late.phases[0].phase.path.curve.breaks[-1] == pytest.approx(first, abs=1e-12)
    assert late.duration == pytest.approx(0.25 * first, rel=2e-3)  # the plan itself stops with its whole force


def test_other_speeds_and_times_are_refused(quick):
    for speed in (0.0, 1.5, "fast"):
        with pytest.raises(rt.InputError, match="speed of an override is a number between"):
            rt.override(quick, speed)
    with pytest.raises(rt.InputError, match="time of a stop is within the plan, from 0 s"):
        rt.stop_on_path(quick, 9.0)
    with pytest.raises(rt.InputError, match="at rest"):
        rt.stop_on_path(quick, 0.0)


def test_the_speed_along_a_path_is_a_number_above_0(arm):
    path = rt.applications.as_path(np.array([A, B]))
    assert rt.constraints.FollowPath(path, speed=0.5).speed == 0.5
    for speed in (0.0, -1.0, "fast"):
        with pytest.raises(rt.InputError, match="speed must be a number above 0"):
            rt.constraints.FollowPath(path, speed=speed)


@pytest.mark.slow
def test_limits_of_jerk_hold_at_lower_speed_across_a_dwell():
    """Knots that moved to a switch of the jerk leave intervals of no width in the path."""
    gentle = rt.load("ur5", limits={"acceleration": 15.0, "jerk": 300.0})
    places = [A, A + [0.5, 0.3, -0.4, 0.2, 0.1, 0], A + [1.0, 0, 0, 0, 0, 0.5]]
    waiting = rt.plan(rt.Waypoints(gentle, places, dwell={1: 0.3}))
    slow = rt.override(waiting, 0.4)
    assert slow.duration == pytest.approx(waiting.duration / 0.4, rel=5e-3)
    assert slow.phases[1].duration == pytest.approx(0.75, rel=1e-3)
    assert rt.validate(slow).passed
