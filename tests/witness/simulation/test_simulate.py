import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from robotraj._util.errors import InputError
from robotraj.witness import simulate


def test_a_free_fall_is_a_parabola(make):
    robot = make.robot([("z", pin.JointModelPZ())])
    motion = simulate(robot, [2.0], [1.0], lambda t, k, q, v: np.zeros(1), (0.0, 1.5))
    t = motion.times
    np.testing.assert_allclose(motion.q[:, 0], 2.0 + t - 0.5 * 9.81 * t**2, atol=1e-11)
    np.testing.assert_allclose(motion.v[:, 0], 1.0 - 9.81 * t, atol=1e-11)


def test_a_pendulum_with_damping_friction_and_armature_follows_its_textbook_equation(make):
    m, length, b, c, armature = 1.3, 0.7, 0.4, 0.3, 0.2
    robot = make.robot([("hinge", pin.JointModelRY())], mass=m, length=length, damping=b, friction=c, armature=armature)

    def textbook(t, x):
        torque = np.sin(5 * t) - b * x[1] - c * np.tanh(x[1] / 0.1) - m * 9.81 * length * np.sin(x[0])
        return [x[1], torque / (m * length**2 + armature)]

    expected = solve_ivp(textbook, (0, 2), [0.5, -1.0], method="Radau", rtol=1e-11, atol=1e-12).y[:, -1]
    motion = simulate(robot, [0.5], [-1.0], lambda t, k, q, v: np.sin([5 * t]), (0.0, 2.0))
    np.testing.assert_allclose([motion.q[-1, 0], motion.v[-1, 0]], expected, atol=1e-8)


def test_energy_of_a_passive_double_pendulum_is_kept(make):
    robot = make.robot([("a", pin.JointModelRY()), ("b", pin.JointModelRY())])
    motion = simulate(robot, [2.0, -1.0], [0.0, 0.5], lambda t, k, q, v: np.zeros(2), (0.0, 5.0))
    data = robot.model.createData()
    energy = [
        pin.computeKineticEnergy(robot.model, data, q, v) + pin.computePotentialEnergy(robot.model, data, q)
        for q, v in zip(motion.q, motion.v, strict=True)
    ]
    assert np.ptp(energy) < 1e-7


def test_a_torque_that_jumps_at_a_knot_is_integrated_exactly(make):
    robot = make.robot([("x", pin.JointModelPX())])
    force = (1.0, -1.0)
    motion = simulate(robot, [0.0], [0.0], lambda t, k, q, v: np.array([force[k]]), (0.0, 2.0), knots=[0.0, 1.0, 2.0])
    assert motion.q[-1, 0] == pytest.approx(1.0, abs=1e-13)
    assert motion.v[-1, 0] == pytest.approx(0.0, abs=1e-13)
    assert motion.times[0] == 0.0 and motion.times[-1] == 2.0 and np.all(np.diff(motion.times) > 0)


def test_a_torque_that_is_lost_is_reported_with_its_time(make):
    robot = make.robot([("x", pin.JointModelPX())])

    def torque(t, k, q, v):
        return np.array([1.0 if t < 0.7 else np.nan])

    motion = simulate(robot, [0.0], [0.0], torque, (0.0, 2.0), knots=[0.5])
    assert not motion.success
    assert 0.5 <= motion.stopped <= 0.7
    assert "diverges" in motion.failure


def test_a_motion_that_explodes_is_reported_with_its_time(make):
    # v' = v^2 from v = 1 is 1 / (1 - t).
    robot = make.robot([("x", pin.JointModelPX())])
    motion = simulate(robot, [0.0], [1.0], lambda t, k, q, v: v**2, (0.0, 2.0), samples_per_interval=100)
    assert not motion.success
    assert motion.stopped == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q0": [0.0, 1.0]}, "q0 has 2 values; it needs 1: x"),
        ({"v0": [np.nan]}, "v0 of joint 'x' is not finite"),
        ({"t_span": (1.0, 1.0)}, "must run forward"),
    ],
)
def test_input_that_cannot_be_simulated_is_refused(make, change, message):
    robot = make.robot([("x", pin.JointModelPX())])
    good = {"q0": [0.0], "v0": [0.0], "torque": lambda t, k, q, v: np.zeros(1), "t_span": (0.0, 1.0)}
    with pytest.raises(InputError, match=message):
        simulate(robot, **{**good, **change})


def test_a_stiff_joint_is_integrated_in_few_evaluations(make):
    """A hinge whose friction has a time constant of 3e-7 s, pushed to and fro: DOP853 would take 4 million of them."""
    robot = make.robot([("hinge", pin.JointModelRY())], mass=1e-3, length=0.1, damping=0.1, friction=0.3)
    count = 0

    def torque(t, k, q, v):
        nonlocal count
        count += 1
        return np.sin([5 * t])

    motion = simulate(robot, [0.5], [0.0], torque, (0.0, 1.0), knots=[0.5])
    assert motion.success and count < 20_000

    def textbook(t, x):
        applied = np.sin(5 * t) - 0.1 * x[1] - 0.3 * np.tanh(x[1] / 0.1) - 1e-3 * 9.81 * 0.1 * np.sin(x[0])
        return [x[1], applied / (1e-3 * 0.1**2)]

    times = motion.times[::5]
    expected = solve_ivp(textbook, (0, 1), [0.5, 0.0], "Radau", times, rtol=1e-11, atol=1e-12, first_step=1e-8).y
    np.testing.assert_allclose([motion.q[::5, 0], motion.v[::5, 0]], expected, atol=1e-8)


def test_a_stiff_motion_that_explodes_is_reported_with_its_time(make):
    robot = make.robot([("hinge", pin.JointModelRY())], mass=1e-3, length=0.1, damping=0.1, friction=0.3)

    def torque(t, k, q, v):
        return np.array([np.sin(5 * t) if t < 0.7 else np.nan])

    motion = simulate(robot, [0.5], [0.0], torque, (0.0, 2.0), knots=[0.5])
    assert not motion.success
    assert 0.5 <= motion.stopped <= 0.7
    assert np.isfinite(motion.q).all()
