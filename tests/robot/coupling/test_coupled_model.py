"""A model with followers moves as the projection of its independent joints: M' = S' M S, h' = S' h."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.point import symbolic_model
from robotraj.robot.coupling.coupled_model import coupled, uncoupled
from robotraj.robot.coupling.dynamics import accelerations, kinetic_energy, mass_matrix, potential_energy
from robotraj.robot.coupling.mimics import Mimic, mimics_of
from tests.robot.coupling.random_trees import random_tree

SEEDS = range(20)


def in_all_joints(model, own, mimics, q, v):
    """Return positions and rates of the independent joints of ``model`` for q and v of the coupled one, and S."""
    place, shares = np.zeros(model.nq), np.zeros((model.nv, own.nv))
    by_follower = {mimic.follower: mimic for mimic in mimics}
    for i in range(1, model.njoints):
        joint, name = model.joints[i], model.names[i]
        mimic = by_follower.get(name)
        there = own.joints[own.getJointId(mimic.leader if mimic else name)]
        m, c = (mimic.multiplier, mimic.offset) if mimic else (1.0, 0.0)
        place[joint.idx_q : joint.idx_q + joint.nq] = m * q[there.idx_q : there.idx_q + there.nq] + c
        shares[joint.idx_v : joint.idx_v + joint.nv, there.idx_v : there.idx_v + there.nv] = m * np.eye(joint.nv)
    return place, shares @ v, shares


def drawn(own, seed):
    rng = np.random.default_rng(1000 + seed)
    q = pin.integrate(own, pin.neutral(own), rng.normal(size=own.nv))
    return q, rng.normal(size=own.nv), rng.normal(size=own.nv)


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_equations_of_motion_are_the_projected_ones(seed, floating):
    model, mimics = random_tree(seed, floating=floating)
    own = coupled(model, mimics)
    q, v, tau = drawn(own, seed)
    place, rates, shares = in_all_joints(model, own, mimics, q, v)
    data, other = own.createData(), model.createData()
    mass = shares.T @ mass_matrix(model, other, place) @ shares
    bias = shares.T @ pin.nonLinearEffects(model, other, place, rates)
    np.testing.assert_allclose(mass_matrix(own, data, q), mass, atol=1e-12)
    a = accelerations(own, data, q, v, tau)
    np.testing.assert_allclose(mass @ a + bias, tau, atol=1e-9)
    assert kinetic_energy(own, data, q, v) == pytest.approx(kinetic_energy(model, other, place, rates))
    assert potential_energy(own, data, q) == pytest.approx(pin.computePotentialEnergy(model, other, place))
    pin.framesForwardKinematics(own, data, q)
    pin.framesForwardKinematics(model, other, place)
    for k in range(7):
        here, there = data.oMf[own.getFrameId(f"tip{k}")], other.oMf[model.getFrameId(f"tip{k}")]
        np.testing.assert_allclose(here.homogeneous, there.homogeneous, atol=1e-12)
    np.testing.assert_allclose(own.damping, np.diag(shares.T @ np.diag(model.damping) @ shares), atol=1e-15)


@pytest.mark.parametrize("seed", SEEDS)
def test_planner_and_witness_agree_though_they_share_no_algorithm(seed):
    model, mimics = random_tree(seed, floating=seed % 2 == 1)
    own = coupled(model, mimics)
    robot = rt.load(own, root="floating" if seed % 2 else "fixed")
    assert set(robot.followers) == set(mimics)
    q, v, tau = drawn(robot.model, seed)
    no_force, symbolic = np.zeros((6, robot.model.njoints)), symbolic_model(robot)
    planned = np.array(symbolic.forward_dynamics(q, v, tau, no_force)).ravel()
    np.testing.assert_allclose(planned, accelerations(robot.model, robot.model.createData(), q, v, tau), rtol=1e-9)
    needed = np.array(symbolic.inverse_dynamics(q, v, planned, no_force)).ravel()
    np.testing.assert_allclose(needed, tau, atol=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_model_comes_back_from_independent_joints(seed):
    model, mimics = random_tree(seed)
    own = coupled(model, mimics)
    again = coupled(uncoupled(own), mimics_of(own))
    q, v, a = drawn(own, seed)
    np.testing.assert_allclose(
        pin.rnea(again, again.createData(), q, v, a), pin.rnea(own, own.createData(), q, v, a), rtol=1e-12, atol=1e-12
    )
    assert list(again.names) == list(own.names)


def fork(*parents):
    """Return a model of joints a, b, c ... on these parents."""
    model = pin.Model()
    for k, parent in enumerate(parents):
        joint = model.addJoint(parent, pin.JointModelPX(), pin.SE3.Random(), "abcdef"[k])
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    return model


def test_branches_are_moved_whole_behind_their_leaders():
    model = fork(0, 1, 0, 3)
    assert list(coupled(model, [Mimic("b", "d", 2.0, 0.0)]).names)[1:] == ["c", "d", "a", "b"]


@pytest.mark.parametrize(
    ("parents", "couplings"), [((0, 1), ("ab",)), ((0, 1, 0, 3), ("bc", "da"))], ids=["carried", "each other's"]
)
def test_couplings_that_pinocchio_has_no_order_for_are_refused_with_the_tag_that_mends_them(parents, couplings):
    mimics = [Mimic(f, leader, 2.0, 0.4) for f, leader in couplings]
    with pytest.raises(rt.InputError, match='Exchange them: give .* multiplier="0.5" offset="-0.2"/>'):
        coupled(fork(*parents), mimics)


@pytest.mark.parametrize("seed", SEEDS)
def test_algorithms_return_alike_when_called_again_on_the_same_data(seed):
    own = coupled(*random_tree(seed, floating=True))
    q, v, a = drawn(own, seed)
    algorithms = (
        lambda data: pin.rnea(own, data, q, v, a),
        lambda data: pin.nonLinearEffects(own, data, q, v),
        lambda data: pin.computeGeneralizedGravity(own, data, q),
        lambda data: pin.computeJointJacobians(own, data, q),
        lambda data: pin.jacobianCenterOfMass(own, data, q),
        lambda data: pin.centerOfMass(own, data, q, v, a),
        lambda data: pin.computeCentroidalMomentum(own, data, q, v).vector,
        lambda data: mass_matrix(own, data, q),
    )
    used = own.createData()
    for algorithm in (*algorithms, *algorithms):
        np.testing.assert_array_equal(algorithm(used), algorithm(own.createData()))
