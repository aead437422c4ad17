"""Terminal pose: its value against Pinocchio, and poses that are reached."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName
from robotraj.witness.point import NumericPoint

FRAME = "tool0"


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


def placed(robot: rt.Robot, q: np.ndarray) -> pin.SE3:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame(FRAME)].copy()


def test_value_is_the_distance_and_the_angle(ur5: rt.Robot) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        q = rng.uniform(-2.0, 2.0, 6)
        target = pin.SE3.Random()
        zero = np.zeros(6)
        end = NumericPoint(ur5, 1.0, q, zero, zero, zero)
        pose = placed(ur5, q)
        angle = np.linalg.norm(pin.log3(target.rotation.T @ pose.rotation))
        expected = 2.0 * np.sum((pose.translation - target.translation) ** 2) + 3.0 * 2.0 * (1.0 - np.cos(angle))
        value = rt.objectives.TerminalPose(FRAME, target, 2.0, 3.0).value(end, end)
        assert float(value) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("with_rotation", [False, True])
def test_a_reachable_pose_is_reached(ur5: rt.Robot, with_rotation: bool) -> None:
    q = np.array([0.5, -1.2, 1.1, -0.4, 0.8, 0.3])
    target = placed(ur5, q)
    wanted = target if with_rotation else target.translation
    phase = rt.Phase(
        ur5,
        duration=2.0,
        start=rt.State(q=[0, -1, 1, 0, 1, 0], v=0),
        end=rt.State(v=0),
        objective=rt.objectives.TerminalPose(FRAME, wanted, 1e4, 1e4) + 1e-8 * rt.Effort(),
    )
    solution = rt.plan(phase, mesh=rt.Mesh(10))
    reached = placed(ur5, solution.at(2.0).q)
    np.testing.assert_allclose(reached.translation, target.translation, atol=1e-5)
    if with_rotation:
        np.testing.assert_allclose(reached.rotation, target.rotation, atol=1e-4)


def test_frames_and_poses_are_checked(ur5: rt.Robot) -> None:
    def phase(objective: rt.objectives.Objective) -> rt.Phase:
        return rt.Phase(ur5, duration=1.0, objective=objective)

    with pytest.raises(UnknownName, match="tool1"):
        phase(rt.objectives.TerminalPose("tool1", [0, 0, 0]))
    with pytest.raises(InputError, match="tool0"):
        phase(rt.objectives.TerminalPose(FRAME, [0, 0]))
    with pytest.raises(InputError, match="finite"):
        phase(rt.objectives.TerminalPose(FRAME, [0, 0, np.nan]))
    with pytest.raises(InputError, match="rotation"):
        phase(rt.objectives.TerminalPose(FRAME, ([0, 0, 0], 2.0 * np.eye(3))))
    with pytest.raises(InputError, match="weight"):
        phase(rt.objectives.TerminalPose(FRAME, [0, 0, 0], -1.0))
