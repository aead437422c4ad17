"""Waypoints without a stop: less time than with stops, poses as waypoints, and closed cycles."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

A = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
B = np.array([0.0, -1.2, 1.2, -1.0, -1.2, 0.6])
C = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur5")


def _pose(robot, q):
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return pin.SE3(data.oMf[robot.frame("tool0")])


def test_passing_takes_less_time_than_stopping(arm):
    passed = rt.plan(rt.Waypoints(arm, [A, B, C]))
    stopped = [
        rt.plan(rt.Phase(arm, (0.01, 20), rt.State(q=p, v=0), rt.State(q=q, v=0), rt.Duration())).duration
        for p, q in ((A, B), (B, C))
    ]
    assert passed.duration < 0.98 * sum(stopped)
    there = passed.at(passed.phases[0].duration)
    assert np.allclose(there.q, B, atol=1e-7) and np.linalg.norm(there.v) > 0.5
    assert rt.validate(passed).passed


def test_poses_are_places(arm, tmp_path):
    pose = _pose(arm, B)
    solution = rt.plan(rt.Waypoints(arm, [A, rt.FramePose("tool0", pose), C]))
    error = pose.actInv(_pose(arm, solution.at(solution.phases[0].duration).q))
    assert np.linalg.norm(pin.log6(error).vector) < 1e-6
    assert solution.duration < rt.plan(rt.Waypoints(arm, [A, B, C])).duration * (1 + 1e-3)
    solution.save(tmp_path / "places.npz")
    assert len(rt.load_solution(tmp_path / "places.npz").phases) == 2


def test_a_cycle_closes_and_repeats_without_a_stop(arm):
    cycle = rt.plan(rt.Waypoints(arm, [A, B, C], cyclic=True))
    first, last = cycle.at(0.0), cycle.at(cycle.duration)
    assert len(cycle.phases) == 3
    assert np.allclose(first.q, A, atol=1e-7) and np.allclose(first.q, last.q, atol=1e-6)
    assert np.allclose(first.v, last.v, atol=1e-6) and np.linalg.norm(first.v) > 0.1


@pytest.mark.parametrize("places", [[A], [A, "B"], [A, B[:3]], [A, np.full(6, np.nan)]])
def test_places_that_are_none_are_refused(arm, places):
    with pytest.raises(rt.InputError, match="[Pp]lace"):
        rt.Waypoints(arm, places)
