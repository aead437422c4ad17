"""Joints whose configuration is no vector: continuous, spherical, planar, floating, composite."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj._util.errors import InputError
from robotraj.symbolic import SymbolicModel


def composite() -> pin.JointModelComposite:
    joint = pin.JointModelComposite()
    for part in (pin.JointModelRX(), pin.JointModelSpherical(), pin.JointModelRUBY()):
        joint.addJoint(part)
    return joint


JOINTS = {
    "continuous": pin.JointModelRUBX(),
    "spherical": pin.JointModelSpherical(),
    "planar": pin.JointModelPlanar(),
    "floating": pin.JointModelFreeFlyer(),
    "Euler angles": pin.JointModelSphericalZYX(),
    "translation": pin.JointModelTranslation(),
    "universal": pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.6, 0.8])),
    "helical": pin.JointModelHelicalUnaligned(np.array([0.6, 0.0, 0.8]), 0.3),
    "oblique": pin.JointModelRevoluteUnaligned(np.array([0.6, 0.0, 0.8])),
    "composite": composite(),
}


@pytest.fixture(params=JOINTS)
def symbolic(request: pytest.FixtureRequest) -> SymbolicModel:
    model = pin.Model()
    joint = model.addJoint(0, JOINTS[request.param], pin.SE3.Identity(), "joint")
    model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    return SymbolicModel(model)


def configuration(model: pin.Model, rng: np.random.Generator) -> np.ndarray:
    return pin.integrate(model, pin.neutral(model), rng.uniform(-2, 2, model.nv))


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-8, 1e-5, 1e-4, 1e-3, 1e-1, 1.0])
def test_steps_of_every_size(symbolic: SymbolicModel, size: float) -> None:
    """The small-angle branches agree with Pinocchio's, and difference undoes integrate."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        q = configuration(symbolic.model, rng)
        dv = size * rng.uniform(-1, 1, symbolic.model.nv)
        q1 = np.array(symbolic.integrate(q, dv)).ravel()
        np.testing.assert_allclose(q1, pin.integrate(symbolic.model, q, dv), rtol=0, atol=1e-14)
        back = np.array(symbolic.difference(q, q1)).ravel()
        np.testing.assert_allclose(back, dv, rtol=0, atol=1e-13)


def test_derivatives_at_rest(symbolic: SymbolicModel) -> None:
    """At dv = 0 integrate has the derivative of the configuration rate, and difference its left inverse."""
    model = symbolic.model
    rng = np.random.default_rng(4)
    q, q1 = ca.SX.sym("q", model.nq), ca.SX.sym("q1", model.nq)
    dv = ca.SX.sym("dv", model.nv)
    by_dv = ca.Function("by_dv", [q, dv], [ca.jacobian(symbolic.integrate(q, dv), dv)])
    by_q1 = ca.Function("by_q1", [q, q1], [ca.jacobian(symbolic.difference(q, q1), q1)])
    rate = ca.Function("rate", [q], [ca.jacobian(symbolic.configuration_rate(q, dv), dv)])
    for _ in range(20):
        here = configuration(model, rng)
        forward, backward = np.array(by_dv(here, 0)), np.array(by_q1(here, here))
        np.testing.assert_allclose(forward, np.array(rate(here)), rtol=0, atol=1e-14)
        np.testing.assert_allclose(backward @ forward, np.eye(model.nv), rtol=0, atol=1e-13)


def test_second_derivatives_at_rest_are_finite(symbolic: SymbolicModel) -> None:
    model = symbolic.model
    here = configuration(model, np.random.default_rng(5))
    q, dv = ca.SX.sym("q", model.nq), ca.SX.sym("dv", model.nv)
    weights = ca.DM(np.random.default_rng(6).standard_normal(model.nq))
    hessian, _ = ca.hessian(ca.dot(weights, symbolic.integrate(q, dv)), dv)
    value = np.array(ca.Function("hessian", [q, dv], [hessian])(here, 0))

    def gradient(step: np.ndarray) -> np.ndarray:
        by_dv = ca.jacobian(ca.dot(weights, symbolic.integrate(q, dv)), dv)
        return np.array(ca.Function("gradient", [q, dv], [by_dv])(here, step)).ravel()

    h = 1e-3
    expected = [(gradient(h * e) - gradient(-h * e)) / (2 * h) for e in np.eye(model.nv)]
    np.testing.assert_allclose(value, expected, rtol=0, atol=1e-5)


def test_the_dynamics_of_every_joint_are_pinocchios(symbolic: SymbolicModel) -> None:
    model = symbolic.model
    rng = np.random.default_rng(8)
    for _ in range(5):
        q, v, a = configuration(model, rng), rng.standard_normal(model.nv), rng.standard_normal(model.nv)
        tau = np.array(symbolic.inverse_dynamics(q, v, a, 0)).ravel()
        np.testing.assert_allclose(tau, pin.rnea(model, model.createData(), q, v, a), rtol=0, atol=1e-10)


def test_a_joint_without_known_dynamics_is_refused() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelEllipsoid(), pin.SE3.Identity(), "knee")
    with pytest.raises(InputError, match="'knee' is a JointModelEllipsoid.*simpler joints"):
        _ = SymbolicModel(model).inverse_dynamics
