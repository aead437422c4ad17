from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation, Slerp

from robotraj import InputError
from robotraj.replay_page.scene.motion import FINEST, keys, motion_of


def replayed(motion, joint: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What three.js shows between keys: linear positions, great arcs."""
    chosen = keys(motion.position[:, joint], motion.quaternion[:, joint])
    stamps = motion.times[chosen]
    position = np.column_stack([np.interp(t, stamps, motion.position[chosen, joint, k]) for k in range(3)])
    return position, Slerp(stamps, Rotation.from_quat(motion.quaternion[chosen, joint]))(t).as_matrix()


@pytest.mark.parametrize("name", ["ur5", "talos"])
def test_poses_between_keys_agree_with_pinocchio(name, request, wave_plan):
    robot = request.getfixturevalue(name)
    plan = wave_plan(robot, 3.0)
    motion = motion_of(robot.model, plan, 30)
    t = np.random.default_rng(5).uniform(0.0, 3.0, 40)
    shown = [replayed(motion, j, t) for j in range(1, robot.model.njoints)]
    data, q = robot.model.createData(), plan.phases[0].at(t).q
    for k in range(len(t)):
        pin.forwardKinematics(robot.model, data, q[k])
        world = {0: (np.zeros(3), np.eye(3))}
        for joint in range(1, robot.model.njoints):
            origin, turn = world[robot.model.parents[joint]]
            position, rotation = shown[joint - 1][0][k], shown[joint - 1][1][k]
            world[joint] = (origin + turn @ position, turn @ rotation)
            np.testing.assert_allclose(world[joint][0], data.oMi[joint].translation, atol=1e-4)
            np.testing.assert_allclose(world[joint][1], data.oMi[joint].rotation, atol=1e-4)


def test_keys_follow_the_bend():
    m = 100 * FINEST + 1
    still = np.zeros((m, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (m, 1))
    assert len(keys(*still)) == 101
    straight = np.outer(np.linspace(0.0, 2.0, m), [1.0, 0.5, 0.0])
    assert len(keys(straight, still[1])) == 101
    bent = straight.copy()
    bent[m // 2 :] += np.outer(np.linspace(0.0, 1.0, m - m // 2) ** 2, [0.0, 0.0, 1.0])
    chosen = keys(bent, still[1])
    assert np.sum(chosen <= m // 2 - FINEST) <= 51
    assert np.sum(chosen >= m // 2) > 150


def test_keys_hold_both_ends_of_any_length():
    for m in (2, 3, FINEST, FINEST + 2, 5 * FINEST + 3):
        chosen = keys(np.zeros((m, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (m, 1)))
        assert chosen[0] == 0
        assert chosen[-1] == m - 1
        assert np.all(np.diff(chosen) > 0)


def test_quaternions_stay_on_one_side_through_many_turns():
    model = pin.Model()
    model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "spin")
    read = lambda t, interval=None: SimpleNamespace(q=15.0 * t[:, None])  # noqa: E731
    phase = SimpleNamespace(t0=0.0, duration=2.0, at=read)
    motion = motion_of(model, SimpleNamespace(phases=(phase,)), 30)
    assert np.all(np.sum(motion.quaternion[1:, 1] * motion.quaternion[:-1, 1], axis=1) > 0.99)


def test_phases_join_on_one_time_line(double_pendulum, wave_plan):
    whole = motion_of(double_pendulum.model, wave_plan(double_pendulum, 2.0, start=1.5), 30)
    cut = motion_of(double_pendulum.model, wave_plan(double_pendulum, 2.0, phases=3, start=1.5), 30)
    for motion in (whole, cut):
        assert np.all(np.diff(motion.times) > 0.0)
        assert motion.times[0] == 1.5
        assert motion.times[-1] == pytest.approx(3.5, abs=1e-12)
    for k in range(2):
        np.testing.assert_allclose(np.interp(cut.times, whole.times, whole.q[:, k]), cut.q[:, k], atol=1e-4)


@pytest.mark.parametrize("duration", [1e5, 1e308])
def test_a_motion_of_too_many_frames_is_refused(duration):
    model = pin.Model()
    model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "spin")
    phase = SimpleNamespace(t0=0.0, duration=duration, at=None)
    with pytest.raises(InputError, match="give a smaller fps"):
        motion_of(model, SimpleNamespace(phases=(phase,)), 30)
