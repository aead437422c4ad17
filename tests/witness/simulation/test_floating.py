"""Forward simulation of a robot whose root floats: plain Pinocchio, unit quaternions, velocities in the body's axes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.witness import simulate
from robotraj.witness.plants.robot_plant import FLYING, RobotPlant

BRICK = (
    '<robot name="brick"><link name="brick"><inertial><mass value="2"/>'
    '<inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
)


@pytest.fixture(scope="module")
def brick(tmp_path_factory):
    path = tmp_path_factory.mktemp("brick") / "brick.urdf"
    path.write_text(BRICK, encoding="utf-8")
    return rt.load(path, root="floating")


def no_torque(t, k, q, v):
    return np.zeros(0)


def test_a_tumbling_brick_keeps_its_angular_momentum_and_energy_and_flies_on_a_parabola(brick):
    v0 = np.array([1.0, 0.2, 3.0, 0.05, 4.0, 0.02])
    done = simulate(brick, brick.neutral, v0, no_torque, (0.0, 4.5), knots=[1.5, 3.0])
    assert done.success
    np.testing.assert_allclose(np.linalg.norm(done.q[:, 3:7], axis=1), 1.0, atol=1e-15)
    inertia = np.diag([1.0, 2.0, 3.0])
    turned = np.array([pin.Quaternion(q[3:7]).matrix() @ inertia @ v[3:] for q, v in zip(done.q, done.v, strict=True)])
    np.testing.assert_allclose(turned, np.tile(turned[0], (len(turned), 1)), atol=1e-7)
    spinning = 0.5 * np.einsum("mi,ij,mj->m", done.v[:, 3:], inertia, done.v[:, 3:])
    np.testing.assert_allclose(spinning, spinning[0], rtol=1e-9)
    fall = v0[:3] * done.times[:, None] + 0.5 * np.outer(done.times**2, [0, 0, -9.81])
    np.testing.assert_allclose(done.q[:, :3], fall, atol=1e-7)
    # About its middle axis it turns over, which distinguishes body axes from world axes.
    assert done.v[:, 4].min() < -3.0


def test_first_states_are_checked(brick):
    with pytest.raises(rt.InputError, match=r"q0: the quaternion .* length 2"):
        simulate(brick, [0, 0, 0, 0, 0, 0, 2], np.zeros(6), no_torque, (0, 1))
    with pytest.raises(rt.InputError, match=r"q0 has 6 values; it needs 7: root_x, .*root_qw"):
        simulate(brick, np.zeros(6), np.zeros(6), no_torque, (0, 1))
    with pytest.raises(rt.InputError, match=r"v0 of joint 'root_wy' is not finite"):
        simulate(brick, brick.neutral, [0, 0, 0, 0, np.nan, 0], no_torque, (0, 1))


def test_drift_of_a_floating_root_is_a_shift_in_the_world_and_a_rotation_vector(brick):
    plan = rt.plan(rt.Phase(brick, 0.4, start=rt.State(q=brick.neutral, v=[1, 0, 2, 0.1, 3, 0])), rt.Mesh(6))
    plant = RobotPlant(plan.phases[0])
    assert plant.gap_names[:6] == tuple(f"q.{name}" for name in FLYING)
    planned = plant.states(np.array([0.3]))
    shifted = planned.copy()
    shifted[0, :3] += [0.1, 0.2, 0.3]
    shifted[0, :7] = np.append(
        shifted[0, :3], pin.integrate(brick.model, shifted[0, :7], np.array([0, 0, 0, 0, 0, 0.05]))[3:]
    )
    shifted[0, 3:7] *= -1.0  # the same attitude
    gaps = plant.gaps(shifted, planned)[0]
    np.testing.assert_allclose(gaps, [0.1, 0.2, 0.3, 0, 0, 0.05, 0, 0, 0, 0, 0, 0], atol=1e-12)
    assert plant.gap_units[:6] == ("m", "m", "m", "rad", "rad", "rad")
    assert rt.validate(plan).passed
