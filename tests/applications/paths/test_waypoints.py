"""Waypoints: less time than with stops, poses as waypoints, closed cycles, stops and dwells."""

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


def test_a_stop_and_a_dwell_take_the_time_of_two_motions_and_the_wait(arm, tmp_path):
    alone = [
        rt.plan(rt.Phase(arm, (0.01, 20), rt.State(q=p, v=0), rt.State(q=q, v=0), rt.Duration())).duration
        for p, q in ((A, B), (B, C))
    ]
    waiting = rt.plan(rt.Waypoints(arm, [A, B, C], dwell={1: 0.3}))
    assert [part.phase.name for part in waiting.phases] == ["leg 1", "dwell at 1", "leg 2"]
    assert waiting.duration == pytest.approx(sum(alone) + 0.3, rel=2e-3)
    rest = waiting.phases[1].at(waiting.phases[1].t0 + np.linspace(0.0, 0.3, 50))
    assert np.abs(rest.q - B).max() < 1e-7 and np.abs(rest.v).max() < 1e-9
    assert rt.validate(waiting).passed
    waiting.save(tmp_path / "waiting.npz")
    assert rt.load_solution(tmp_path / "waiting.npz").duration == waiting.duration


def test_true_stops_at_every_place_and_a_number_at_one(arm):
    every, one = (rt.Waypoints(arm, [A, B, C, A], stop=stop) for stop in (True, [2]))
    still = [[float(phase.end.v) if phase.end.v is not None else None for phase in p.phases] for p in (every, one)]
    assert still == [[0.0, 0.0, 0.0], [None, 0.0, 0.0]]
    cyclic = rt.Waypoints(arm, [A, B, C], cyclic=True, stop=[0], dwell={0: 0.2})
    assert cyclic.phases[0].start.v == 0.0 and cyclic.phases[-1].name == "dwell at 0"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"stop": [3]}, "names place 3; the motion arrives at the places 1, 2"),
        ({"dwell": {0: 1.0}}, "names place 0"),
        ({"dwell": {1: 0.0}}, "a time above 0 s"),
        ({"dwell": 0.5}, "maps numbers of places"),
    ],
)
def test_stops_are_at_places_where_a_leg_ends(arm, options, words):
    with pytest.raises(rt.InputError, match=words):
        rt.Waypoints(arm, [A, B, C], **options)
