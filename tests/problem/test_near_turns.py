"""Angles up to whole turns are those nearest to the other end; far goals and wrapped paths are told."""

from __future__ import annotations

import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

LIMITS = {"velocity": 1.5, "effort": 60.0}


def turntable(limits=None):
    """A joint that turns without end, of 0.5 kg m^2, beside a slide of 1 kg."""
    model = pin.Model()
    parent = 0
    for name, kind in (("turn", pin.JointModelRZ()), ("slide", pin.JointModelPX())):
        parent = model.addJoint(parent, kind, pin.SE3.Identity(), name)
        model.appendBodyToJoint(parent, pin.Inertia(1.0, np.zeros(3), 0.5 * np.eye(3)), pin.SE3.Identity())
    return rt.load(model, limits=LIMITS | (limits or {}))


@pytest.mark.parametrize("whole", [-2, 0, 1, 5])
@pytest.mark.parametrize("angle", [-3.0, 3.0, 0.0, 9.0])
def test_the_near_turn_is_at_most_half_a_turn_away(whole, angle):
    start = 3.0 + 2.0 * np.pi * whole
    for q in ({"turn": rt.turns(angle), "slide": 1.0}, [rt.turns(angle), 1.0]):
        phase = rt.Phase(turntable(), 5.0, rt.State(q=[start, 0.0], v=0), rt.State(q=q, v=0))
        end = phase.end_bounds.lower[0]
        assert abs(end - start) <= np.pi
        assert np.cos(end) == pytest.approx(np.cos(angle)) and np.sin(end) == pytest.approx(np.sin(angle), abs=1e-9)


def test_the_short_way_takes_the_least_time():
    robot = turntable()
    way = 2.0 * np.pi - 6.0
    ends = rt.State(q=[3.0, 0.0], v=0), rt.State(q={"turn": rt.turns(-3.0), "slide": 0.0}, v=0)
    solution = rt.plan(rt.Phase(robot, (0.05, 9.0), *ends, rt.Duration()), progress=False)
    # Both bodies turn: 1 kg m^2 by 60 N m, below the speed limit of 1.5 rad/s on this way after 0.025 s.
    assert solution.duration == pytest.approx(way / 1.5 + 1.5 / 60.0, rel=1e-3)
    assert solution.at(solution.duration).q[0] - 3.0 == pytest.approx(way, abs=1e-8)


def test_limits_choose_the_turn_and_starts_may_be_turns():
    robot = turntable({"position": {"turn": (-4.0, 4.0)}})
    start = rt.State(q=[3.0, 0.0], v=0)
    phase = rt.Phase(robot, 9.0, start, rt.State(q=[rt.turns(-3.0), 0.0], v=0))
    assert phase.end_bounds.lower[0] == pytest.approx(2.0 * np.pi - 3.0)
    narrow = robot.limits.with_(position={"turn": (-3.2, 3.2)})
    phase = rt.Phase(robot, 9.0, start, rt.State(q=[rt.turns(-3.0), 0.0], v=0), limits=narrow)
    assert phase.end_bounds.lower[0] == -3.0
    phase = rt.Phase(robot, 9.0, rt.State(q={"turn": rt.turns(2.0 * np.pi + 1.0)}), rt.State(q=[0.0, 0.0]))
    assert phase.start_bounds.lower[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("q", "part"),
    [
        ({"slide": rt.turns(1.0)}, "it is no angle"),
        ({"turm": rt.turns(1.0)}, "turm"),
        ([rt.turns(1.0)], "it needs 2"),
    ],
)
def test_turns_where_there_are_none_are_refused(q, part):
    with pytest.raises(rt.InputError, match=part):
        rt.Phase(turntable(), 1.0, None, rt.State(q=q))
    with pytest.raises(rt.InputError, match="finite number"):
        rt.turns(np.inf)


def test_no_turn_within_the_limits_is_refused():
    robot = turntable({"position": {"turn": (-1.0, 1.0)}})
    with pytest.raises(rt.InputError, match=r"up to whole turns; no such angle .* within its limits \[-1, 1\] rad"):
        rt.Phase(robot, 1.0, rt.State(q=0), rt.State(q=[rt.turns(3.0), 0.0]))


def test_a_goal_more_than_half_a_turn_away_is_told():
    ends = rt.State(q=[3.0, 0.0], v=0), rt.State(q=[-3.0, 0.0], v=0)
    with pytest.warns(UserWarning, match=r"'turn' turns by -6 rad .* 0.2832 rad away.* rt.turns\(-3\)"):
        rt.Phase(turntable(), 9.0, *ends)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.Phase(turntable({"position": {"turn": (-4.0, 4.0)}}), 9.0, *ends)


def test_a_recorded_path_that_wraps_is_unwrapped():
    path = np.array([[2.6, 0.0], [3.0, 0.1], [-2.9, 0.2], [-2.5, 0.3]])
    with pytest.warns(UserWarning, match=r"jumps by nearly a turn.*'turn' at configuration 2"):
        solution = rt.retime(path, turntable(), progress=False)
    q = solution.at(np.linspace(0.0, solution.duration, 99)).q[:, 0]
    assert q.min() >= 2.6 - 1e-9 and q.max() == pytest.approx(2.0 * np.pi - 2.5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.retime(path[:2], turntable(), progress=False)
