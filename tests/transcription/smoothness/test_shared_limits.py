"""Sizes of accelerations under limits that joints share: closed forms, other ways to write a limit, no such limit."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.transcription.smoothness.shared_limits import acceleration_sizes

UR5 = rt.load("ur5")
HOME = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])


def size(*constraints, limits=None):
    ends = rt.State(q=HOME, v=0), rt.State(q=HOME + 0.5, v=0)
    phase = rt.Phase(UR5, (0.1, 20), *ends, rt.Duration(), constraints, limits=limits or UR5.limits)
    sizes = acceleration_sizes(phase)
    assert len(set(sizes.tolist())) == 1
    return sizes[0]


def lever():
    """Return how far the tool moves at most when one joint turns by 1 rad, in the neutral configuration [m]."""
    data = UR5.model.createData()
    jacobian = pin.computeFrameJacobian(UR5.model, data, UR5.neutral, UR5.frame("tool0"), pin.LOCAL)
    return np.linalg.norm(jacobian[:3], axis=0).max()


@pytest.mark.parametrize("limit", [0.1, 2.0])
def test_the_joint_that_moves_the_tool_most_determines_the_size(limit):
    speed = size(rt.constraints.FrameSpeed("tool0", linear=limit))
    assert speed == pytest.approx(12.0 * (limit / lever()) ** 2)
    assert size(rt.constraints.FrameAcceleration("tool0", linear=limit)) == pytest.approx(limit / lever())


def test_the_least_size_of_several_limits_counts():
    slow, fast = (rt.constraints.FrameSpeed("tool0", linear=limit) for limit in (0.1, 1.0))
    assert size(fast, slow) == size(slow) < size(fast)


def test_the_size_does_not_depend_on_how_a_limit_is_written():
    def limited(power, unit):
        return size(
            rt.PathConstraint(
                lambda point: unit * point.frame("tool0").velocity[1] ** power,
                -np.inf if power == 2 else -unit * 0.3,
                unit * 0.3**power,
            )
        )

    assert limited(1, 1.0) == pytest.approx(limited(2, 1.0))
    assert limited(1, 1.0) == pytest.approx(limited(1, 1e3))


def test_a_power_limits_the_speed_at_which_a_motor_lifts_the_arm():
    held = np.abs(pin.rnea(UR5.model, UR5.model.createData(), HOME, np.zeros(6), np.zeros(6))).max()
    assert size(rt.constraints.MotorPower(5.0)) == pytest.approx(12.0 * (5.0 / held) ** 2)


@pytest.mark.slow
def test_a_weak_power_is_met_within_few_iterations():
    ends = rt.State(q=HOME, v=0), rt.State(q=HOME + [1.4, 0.5, -0.5, 0.3, 0.4, 0.5], v=0)
    phase = rt.Phase(UR5, (0.1, 10), *ends, rt.Duration(), [rt.constraints.MotorPower(5.0)])
    solution = rt.plan(phase)
    assert solution.proof.holds
    assert solution.iterations < 150


def test_bounds_of_variables_positions_and_equations_have_none():
    limits = UR5.limits.with_(acceleration=5.0)
    here = rt.PathConstraint(lambda point: point.frame("tool0").position[2], -1.0, 2.0)
    still = rt.PathConstraint(lambda point: point.frame("tool0").velocity[2], 0.0, 0.0)
    assert size(here, still, limits=limits) == np.inf


@pytest.mark.slow
@pytest.mark.parametrize("limit", [rt.constraints.FrameAcceleration, rt.constraints.FrameSpeed])
def test_slow_motions_of_an_arm_with_seven_joints_are_proved(limit):
    panda = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    start, end = [0, -0.8, 0, -2.3, 0, 1.6, 0.8], [1.5, 0.4, -0.6, -1.2, 0.5, 2.2, -0.5]
    slow = limit("panda_hand_tcp", linear=0.2)
    phase = rt.Phase(panda, (0.1, 50), rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Duration(), [slow])
    solution = rt.plan(phase)
    assert solution.proof.holds
    assert solution.iterations < 150
