"""The linearised motion against finite differences of the simulated one."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.coupling.dynamics import accelerations
from robotraj.solution.feedback.linearisation import Linearisation
from robotraj.witness.contacts.stance import Stance
from tests.robot.coupling.random_trees import random_tree

STEP = 1e-6


def slopes(robot, acceleration, q, v):
    """Central differences of the acceleration by q and v."""
    columns = []
    for unit in STEP * np.eye(robot.nv):
        ahead, behind = (acceleration(pin.integrate(robot.model, q, s * unit), v) for s in (1, -1))
        columns.append((ahead - behind) / (2 * STEP))
    for unit in STEP * np.eye(robot.nv):
        columns.append((acceleration(q, v + unit) - acceleration(q, v - unit)) / (2 * STEP))
    return np.column_stack(columns)


def test_a_free_arm_with_damping_and_friction(rng):
    robot = rt.load("z1")
    q, v, tau = 0.3 * rng.normal(size=robot.nq), rng.normal(size=robot.nv), rng.normal(size=robot.nu)
    found = Linearisation(robot, ()).at(q, v, tau)

    def acceleration(q, v):
        return pin.aba(robot.model, robot.model.createData(), q, v, tau - robot.dissipation(v)).copy()

    expected = slopes(robot, acceleration, q, v)
    np.testing.assert_allclose(found.rate[robot.nv :], expected, atol=1e-6 * np.abs(expected).max())
    np.testing.assert_array_equal(found.rate[: robot.nv], np.eye(2 * robot.nv)[robot.nv :])
    np.testing.assert_array_equal(found.consistent, np.eye(2 * robot.nv))


@pytest.mark.parametrize("seed", range(3))
def test_a_robot_whose_joints_follow_others(seed, rng):
    robot = rt.load(coupled(*random_tree(seed)))
    q, v, tau = 0.3 * rng.normal(size=robot.nq), rng.normal(size=robot.nv), rng.normal(size=robot.nu)
    found = Linearisation(robot, ()).at(q, v, tau)

    def acceleration(q, v):
        return accelerations(robot.model, robot.model.createData(), q, v, tau - robot.dissipation(v))

    expected = slopes(robot, acceleration, q, v)
    np.testing.assert_allclose(found.rate[robot.nv :], expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("flat", [False, True])
def test_a_floating_robot_whose_feet_hold(rng, flat):
    robot = rt.load("solo12", root="floating")
    feet = ("FL_FOOT", "HR_FOOT")
    contacts = [rt.contacts.FlatFoot(f, 0.02, 0.02) if flat else rt.PointContact(f) for f in feet]
    if flat:
        contacts = contacts[:1]
    bound = rt.Phase(robot, duration=1.0, contacts=contacts).bound_contacts
    q = pin.integrate(robot.model, np.array(robot.neutral), 0.3 * rng.normal(size=robot.nv))
    stance = Stance(robot, bound, {anchor.name: 0.0 for contact in bound for anchor in contact.anchors})
    v, _ = stance.strike(q, 0.5 * rng.normal(size=robot.nv))
    tau = rng.normal(size=robot.nu)
    found = Linearisation(robot, bound).at(q, v, tau)

    def acceleration(q, v):
        return stance.acceleration(q, v, robot.actuation @ tau - robot.dissipation(v))

    if not flat:
        # The rows of a flat foot are small angles; where it is not flat, their rates are not the angular velocity.
        expected = slopes(robot, acceleration, q, v)
        np.testing.assert_allclose(found.rate[robot.nv :], expected, atol=1e-6 * np.abs(expected).max())
    held = stance.rows(q, v).jacobian
    # Torques leave the feet where they are, and consistent deviations are not moved again.
    np.testing.assert_allclose(held @ found.input[robot.nv :], 0.0, atol=1e-8 * np.abs(found.input).max())
    np.testing.assert_allclose(
        found.consistent @ found.consistent, found.consistent, atol=1e-9 * np.abs(found.consistent).max()
    )


@pytest.fixture
def rng():
    return np.random.default_rng(3)
