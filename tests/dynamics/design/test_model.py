"""Symbolic and plain numbers of a designed robot are of one robot."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.design.binding import Design
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.symbolic import SymbolicModel
from robotraj.witness.point import NumericPoint

QUANTITIES = {
    "m": rt.design.BodyMass("forearm_link"),
    "L": rt.design.LinkLength("shoulder_lift_joint"),
    "l": rt.design.LinkLength("wrist_3_joint", tip="tool0"),
    "w": rt.design.Payload("tool0"),
    "d": rt.design.JointDamping("elbow_joint"),
}
VALUES = {"m": 3.1, "L": 0.61, "l": 0.2, "w": 1.3, "d": 0.4}
NAMES = list(QUANTITIES)
# The last frames are on scaled bodies; one is rotated relative to its joint.
FRAMES = ["shoulder_link", "wrist_1_link", "ee_link", "tool0"]


@pytest.fixture(scope="module")
def motion(ur5) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(11)
    return {name: rng.uniform(-1.5, 1.5, ur5.nv) for name in ("q", "v", "a", "tau")}


@pytest.fixture(scope="module")
def point(ur5):
    """The symbolic point, its symbols (q, v, a, tau, p) in this order."""
    symbols = [ca.SX.sym(name, ur5.nv) for name in ("q", "v", "a", "tau")] + [ca.SX.sym("p", len(NAMES))]
    q, v, a, tau, p = symbols
    dae = InverseDynamics().of(ur5, Design(ur5, QUANTITIES))
    return dae, dae.point(ca.SX(0), ca.vertcat(q, v), a, tau, p, NAMES), symbols


@pytest.fixture(scope="module")
def numeric(ur5, motion) -> NumericPoint:
    return NumericPoint(Design(ur5, QUANTITIES).realise(VALUES), 0.0, **motion)


def evaluate(expression, symbols, motion) -> np.ndarray:
    function = ca.Function("f", symbols, [ca.densify(ca.SX(expression))])
    return np.array(function(*motion.values(), list(VALUES.values()))).squeeze()


@pytest.mark.parametrize("name", ["com", "momentum", "mass"])
def test_what_the_whole_robot_has(point, numeric, motion, name: str) -> None:
    _, symbolic, symbols = point
    actual = evaluate(getattr(symbolic, name), symbols, motion)
    np.testing.assert_allclose(actual, getattr(numeric, name), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("what", ["position", "rotation", "velocity", "acceleration"])
@pytest.mark.parametrize("frame", FRAMES)
def test_frames(point, numeric, motion, frame: str, what: str) -> None:
    _, symbolic, symbols = point
    actual = evaluate(getattr(symbolic.frame(frame), what), symbols, motion)
    np.testing.assert_allclose(actual, getattr(numeric.frame(frame), what), rtol=0, atol=1e-11)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_frame_moves_by_its_jacobian(point, motion, frame: str) -> None:
    _, symbolic, symbols = point
    product = ca.mtimes(symbolic.symbolic.frame_jacobian(frame)(symbolic.q), symbolic.v)
    difference = evaluate(product - symbolic.frame(frame).velocity, symbols, motion)
    np.testing.assert_allclose(difference, 0, rtol=0, atol=1e-12)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_frame_moves_with_the_lengths(ur5, motion, frame: str) -> None:
    design = Design(ur5, QUANTITIES)
    stretched = NumericPoint(design.realise(VALUES), 0.0, **motion).frame(frame).position
    moved = np.linalg.norm(stretched - NumericPoint(ur5, 0.0, **motion).frame(frame).position)
    assert (moved > 0.1) == (frame != "shoulder_link")


def test_torque_balance(ur5, point, numeric, motion) -> None:
    dae, symbolic, symbols = point
    plain = InverseDynamics().of(Design(ur5, QUANTITIES).realise(VALUES))
    q, v, a, tau, p = symbols
    expected = plain.residual(plain.point(ca.SX(0), ca.vertcat(q, v), a, tau, p, NAMES))
    difference = evaluate(dae.residual(symbolic) - expected, symbols, motion)
    np.testing.assert_allclose(difference, 0, rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("name", "inputs"),
    [
        ("mass_matrix", "q"),
        ("nonlinear_effects", "qv"),
        ("gravity", "q"),
        ("kinetic_energy", "qv"),
        ("potential_energy", "q"),
    ],
)
def test_symbolic_algorithms_equal_those_of_the_realised_model(ur5, point, motion, name: str, inputs: str) -> None:
    _, symbolic, symbols = point
    arguments = [getattr(symbolic, letter) for letter in inputs]
    plain = SymbolicModel(Design(ur5, QUANTITIES).realise(VALUES).model)
    actual = evaluate(getattr(symbolic.symbolic, name)(*arguments), symbols, motion)
    expected = np.array(getattr(plain, name)(*(motion[letter] for letter in inputs))).squeeze()
    np.testing.assert_allclose(actual, expected, rtol=1e-12, atol=1e-11)


def test_forward_dynamics_inverts_inverse_dynamics(ur5, point, motion) -> None:
    _, symbolic, symbols = point
    none = ca.SX(6, ur5.model.njoints)
    tau = symbolic.symbolic.inverse_dynamics(symbolic.q, symbolic.v, symbolic.a, none)
    a = symbolic.symbolic.forward_dynamics(symbolic.q, symbolic.v, tau, none)
    np.testing.assert_allclose(evaluate(a, symbols, motion), motion["a"], rtol=0, atol=1e-10)


def test_an_unknown_algorithm_is_refused(point) -> None:
    with pytest.raises(AttributeError, match="coriolis"):
        _ = point[1].symbolic.coriolis
