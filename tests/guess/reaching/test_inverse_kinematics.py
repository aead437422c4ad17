"""Inverse kinematics: random reachable targets are reached inside the limits; others are refused by name."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName
from robotraj.guess.reaching.inverse_kinematics import reach

FRAMES = {"ur5": "tool0", "panda": "panda_hand_tcp", "two_link_arm": "tip"}


def placed(robot: rt.Robot, frame: str, q: np.ndarray) -> pin.SE3:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame(frame)].copy()


@pytest.mark.parametrize("name", FRAMES)
@pytest.mark.parametrize("with_rotation", [False, True])
def test_random_reachable_targets_are_reached_inside_the_limits(name: str, with_rotation: bool) -> None:
    robot, frame = rt.load(name), FRAMES[name]
    limits = robot.limits
    rng = np.random.default_rng(2)
    low, high = np.maximum(limits.position_lower, -np.pi), np.minimum(limits.position_upper, np.pi)
    for _ in range(10):
        pose = placed(robot, frame, rng.uniform(low, high))
        target = pose if with_rotation else pose.translation
        q = reach(robot, frame, target, robot.neutral, limits.position_lower, limits.position_upper)
        found = placed(robot, frame, q)
        np.testing.assert_allclose(found.translation, pose.translation, atol=1e-7)
        if with_rotation:
            np.testing.assert_allclose(found.rotation, pose.rotation, atol=1e-7)
        assert np.all((q >= limits.position_lower) & (q <= limits.position_upper))


def test_the_guess_ends_at_the_target_and_passes_the_waypoints() -> None:
    robot = rt.load("ur5")
    phase = rt.Phase(robot, duration=2.0, start=rt.State(q=[0, -1, 1, 0, 1, 0], v=0), end=rt.State(v=0))
    guess = rt.guess.InverseKinematics("tool0", [0.4, 0.3, 0.5], waypoints=[[0.5, 0.0, 0.6]], fractions=[0, 0.5, 1])
    states = guess.of(phase, 0).states(np.array([0.0, 0.5, 1.0]))
    places = [placed(robot, "tool0", q).translation for q in states[:, :6]]
    np.testing.assert_allclose(places[1:], [[0.5, 0.0, 0.6], [0.4, 0.3, 0.5]], atol=1e-7)
    np.testing.assert_allclose(states[0], [0, -1, 1, 0, 1, 0, *np.zeros(6)], atol=1e-12)
    np.testing.assert_allclose(states[-1, 6:], 0.0, atol=1e-12)


def test_joints_that_the_end_fixes_stay_there() -> None:
    robot = rt.load("panda")
    fixed = robot.joint_names[2]
    phase = rt.Phase(robot, duration=2.0, start=rt.State(v=0), end=rt.State(q={fixed: 0.3}, v=0))
    states = rt.guess.InverseKinematics("panda_hand_tcp", [0.4, 0.2, 0.5]).of(phase, 0).states(np.array([1.0]))
    assert states[0, 2] == pytest.approx(0.3, abs=1e-12)
    np.testing.assert_allclose(placed(robot, "panda_hand_tcp", states[0, :7]).translation, [0.4, 0.2, 0.5], atol=1e-7)


def test_a_target_out_of_reach_names_the_frame_and_the_distance() -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, duration=2.0, start=rt.State(q=0, v=0))
    stretched = placed(arm, "tip", np.zeros(2)).translation
    with pytest.raises(InputError, match=r"Frame 'tip' of 'two_link_arm' cannot reach the target .* 1 m away"):
        rt.guess.InverseKinematics("tip", stretched * (1.0 + 1.0 / np.linalg.norm(stretched))).of(phase, 0)


def test_joints_at_limits_are_named() -> None:
    arm = rt.load("two_link_arm", limits={"position": {"shoulder": (-0.1, 0.1)}})
    free = rt.load("two_link_arm")
    target = placed(free, "tip", np.array([1.5, 0.3])).translation
    phase = rt.Phase(arm, duration=2.0, start=rt.State(q=0, v=0))
    with pytest.raises(InputError, match="shoulder at 0.1 rad"):
        rt.guess.InverseKinematics("tip", target).of(phase, 0)


def test_unknown_frames_and_systems_are_refused() -> None:
    arm = rt.load("two_link_arm")
    with pytest.raises(UnknownName, match="tpi"):
        rt.guess.InverseKinematics("tpi", [0, 0, 0]).of(rt.Phase(arm, duration=1.0), 0)
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    with pytest.raises(InputError, match="needs a robot"):
        rt.guess.InverseKinematics("tip", [0, 0, 0]).of(rt.Phase(system, duration=1.0), 0)
