"""Functions with the inertial parameters and the joint translations as inputs."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj.symbolic import SymbolicModel

NAMES = [
    "forward_dynamics",
    "inverse_dynamics",
    "mass_matrix",
    "nonlinear_effects",
    "gravity",
    "kinetic_energy",
    "potential_energy",
    "center_of_mass",
    "centroidal_momentum",
]


@pytest.fixture(scope="module")
def parametric(arm) -> SymbolicModel:
    return SymbolicModel(arm.model, parametric=True)


@pytest.fixture(scope="module")
def other(arm) -> pin.Model:
    """The arm with other masses, inertias and link lengths."""
    rng = np.random.default_rng(7)
    model = arm.model.copy()
    for joint in range(1, model.njoints):
        model.inertias[joint] = pin.Inertia.FromDynamicParameters(
            model.inertias[joint].toDynamicParameters() * rng.uniform(0.9, 1.1)
        ) + pin.Inertia.FromSphere(rng.uniform(0.1, 1.0), 0.1)
        model.jointPlacements[joint].translation = model.jointPlacements[joint].translation + 0.1 * rng.random(3)
    return model


@pytest.mark.parametrize("name", NAMES)
def test_own_parameters_give_the_plain_function(arm, parametric: SymbolicModel, name: str) -> None:
    point = arm.point(0)
    plain, extended = getattr(arm.symbolic, name), getattr(parametric, name)
    assert extended.name_in() == [*plain.name_in(), "inertias", "translations"]
    values = [point[key] for key in plain.name_in()]
    own = [parametric.model_inertias, parametric.model_translations]
    for mine, theirs in zip(extended.call([*values, *own]), plain.call(values), strict=True):
        np.testing.assert_allclose(np.array(mine), np.array(theirs), rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("name", NAMES)
def test_other_parameters_give_the_other_robot(arm, other: pin.Model, parametric: SymbolicModel, name: str) -> None:
    point = arm.point(1)
    rebuilt = SymbolicModel(other)
    plain = getattr(rebuilt, name)
    values = [point[key] for key in plain.name_in()]
    parameters = [rebuilt.model_inertias, rebuilt.model_translations]
    changed = False
    for mine, theirs, before in zip(
        getattr(parametric, name).call([*values, *parameters]),
        plain.call(values),
        getattr(arm.symbolic, name).call(values),
        strict=True,
    ):
        np.testing.assert_allclose(np.array(mine), np.array(theirs), rtol=1e-9, atol=1e-9)
        changed = changed or not np.allclose(np.array(mine), np.array(before))
    assert changed


def test_frame_moves_with_the_translations(arm, other: pin.Model, parametric: SymbolicModel) -> None:
    rebuilt = SymbolicModel(other)
    q = arm.point(2)["q"]
    position, _ = parametric.frame_placement("tool0")(q, rebuilt.model_inertias, rebuilt.model_translations)
    expected, _ = rebuilt.frame_placement("tool0")(q)
    np.testing.assert_allclose(np.array(position), np.array(expected), rtol=0, atol=1e-12)


def test_inverse_dynamics_is_linear_in_the_inertias(arm, parametric: SymbolicModel) -> None:
    """Without armature, its derivative is Pinocchio's joint torque regressor."""
    point = arm.point(3)
    names = parametric.inverse_dynamics.name_in()
    values = {name: ca.SX.sym(name, parametric.inverse_dynamics.sparsity_in(i)) for i, name in enumerate(names)}
    tau = parametric.inverse_dynamics.call(list(values.values()))[0]
    regressor = ca.Function("regressor", list(values.values()), [ca.jacobian(tau, ca.vec(values["inertias"]))])
    own = {"inertias": parametric.model_inertias, "translations": parametric.model_translations}
    actual = np.array(regressor.call([{**point, **own}[name] for name in names])[0])
    expected = pin.computeJointTorqueRegressor(arm.model, arm.data, point["q"], point["v"], point["a"])
    assert not actual[:, :10].any(), "the universe has no weight"
    np.testing.assert_allclose(actual[:, 10:], expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_body_without_mass_keeps_derivatives_finite() -> None:
    model = pin.Model()
    first = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "first")
    second = model.addJoint(first, pin.JointModelRY(), pin.SE3.Identity(), "second")
    model.appendBodyToJoint(second, pin.Inertia.Random(), pin.SE3.Identity())
    symbolic = SymbolicModel(model, parametric=True)
    mass = symbolic.mass_matrix
    values = [ca.SX.sym(name, mass.sparsity_in(i)) for i, name in enumerate(mass.name_in())]
    derivative = ca.Function("d", values, [ca.jacobian(ca.vec(mass.call(values)[0]), ca.vec(values[1]))])
    value = np.array(derivative([0.3, 0.4], symbolic.model_inertias, symbolic.model_translations))
    assert np.isfinite(value).all()
    assert value.any()
