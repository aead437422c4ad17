"""First derivatives agree with Pinocchio's analytical ones and with finite differences.

Derivatives with respect to q are taken in the tangent space: of f(integrate(q, d)) by d, at d = 0. So they
also check that ``integrate`` is smooth there, which its branches for small angles make a real question.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

COUNT = 10
ANALYTICAL = 1e-9
FINITE = 1e-7
ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def symbols(function: ca.Function) -> dict[str, ca.SX]:
    return {name: ca.SX.sym(name, function.sparsity_in(i)) for i, name in enumerate(function.name_in())}


def jacobians(case: Any, function: ca.Function, by: Sequence[str]) -> list[np.ndarray]:
    """Jacobians of the first output by each named input, by q in the tangent space, at COUNT points."""
    values = symbols(function)
    step = ca.SX.sym("step", case.model.nv)
    moved = {**values, "q": case.symbolic.integrate(values["q"], step)}
    expression = function.call(list(moved.values()))[0]
    results = [ca.substitute(ca.jacobian(expression, step if name == "q" else values[name]), step, 0) for name in by]
    outputs = [f"by_{name}" for name in by]
    return case.evaluate(ca.Function("jacobians", list(values.values()), results, list(values), outputs), COUNT)


def assert_agrees(actual: np.ndarray, expected: Sequence[np.ndarray], relative: float) -> None:
    reference = np.array(expected).reshape(actual.shape)
    scale = np.abs(reference).max(axis=(1, 2), keepdims=True)
    assert (scale > 0).all(), "a reference of zeros compares nothing"
    assert np.abs((actual - reference) / scale).max() < relative


def aba(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    return pin.computeABADerivatives(model, data, p["q"], p["v"], p["tau"], p["forces"])


def rnea(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    dq, dv, upper = pin.computeRNEADerivatives(model, data, p["q"], p["v"], p["a"], p["forces"])
    return [dq, dv, np.triu(upper) + np.triu(upper, 1).T]


def nonlinear_effects(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    return pin.computeRNEADerivatives(model, data, p["q"], p["v"], np.zeros(model.nv))[:2]


def gravity(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    return [pin.computeGeneralizedGravityDerivatives(model, data, p["q"])]


def potential_energy(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    return [pin.computeGeneralizedGravity(model, data, p["q"])]


def kinetic_energy(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    """The energy's derivative by v is the momentum M v."""
    upper = np.triu(pin.crba(model, data, p["q"]))
    return [(upper + np.triu(upper, 1).T) @ p["v"]]


def center_of_mass(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    return [pin.jacobianCenterOfMass(model, data, p["q"])]


def centroidal_momentum(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> list[np.ndarray]:
    by_q = pin.computeCentroidalDynamicsDerivatives(model, data, p["q"], p["v"], p["a"])[0].copy()
    return [by_q, pin.computeCentroidalMap(model, data, p["q"])]


DERIVATIVES: dict[str, tuple[tuple[str, ...], Callable[..., list[np.ndarray]]]] = {
    "forward_dynamics": (("q", "v", "tau"), aba),
    "inverse_dynamics": (("q", "v", "a"), rnea),
    "nonlinear_effects": (("q", "v"), nonlinear_effects),
    "gravity": (("q",), gravity),
    "potential_energy": (("q",), potential_energy),
    "kinetic_energy": (("v",), kinetic_energy),
    "center_of_mass": (("q",), center_of_mass),
    "centroidal_momentum": (("q", "v"), centroidal_momentum),
}


@pytest.mark.parametrize("name", DERIVATIVES)
def test_derivatives_equal_the_analytical_ones_of_pinocchio(case, name: str) -> None:
    by, reference = DERIVATIVES[name]
    actual = jacobians(case, getattr(case.symbolic, name), by)
    expected = [[np.array(part) for part in reference(case.model, case.data, case.point(i))] for i in range(COUNT)]
    for index, jacobian in enumerate(actual):
        assert_agrees(jacobian, [row[index] for row in expected], ANALYTICAL)


@pytest.mark.parametrize("reference", [ALIGNED, pin.ReferenceFrame.LOCAL], ids=str)
def test_frame_velocity(case, reference: pin.ReferenceFrame) -> None:
    """Pinocchio's aligned derivative is that of the velocity at a point fixed in the world, not in the frame.

    The origin moves with J dq under an angular velocity omega, so omega x J separates the two.
    """
    model, data = case.model, case.data
    name = case.frames[-1]
    frame = model.getFrameId(name)
    actual = jacobians(case, case.symbolic.frame_velocity(name, reference), ("q", "v"))
    expected = []
    for i in range(COUNT):
        p = case.point(i)
        pin.computeForwardKinematicsDerivatives(model, data, p["q"], p["v"], p["a"])
        by_q, by_v = pin.getFrameVelocityDerivatives(model, data, frame, reference)
        if reference == ALIGNED:
            omega = pin.getFrameVelocity(model, data, frame, reference).angular
            by_q[:3] += pin.skew(omega) @ by_v[:3]
        expected.append((by_q, by_v))
    for index, jacobian in enumerate(actual):
        assert_agrees(jacobian, [row[index] for row in expected], ANALYTICAL)


def test_frame_placement(case) -> None:
    """The position's derivative is the upper half of the aligned frame Jacobian."""
    name = case.frames[-1]
    (actual,) = jacobians(case, case.symbolic.frame_placement(name), ("q",))
    (expected,) = case.evaluate(case.symbolic.frame_jacobian(name), COUNT)
    assert_agrees(actual, list(expected[:, :3]), ANALYTICAL)


OF_MODEL = [*DERIVATIVES, "mass_matrix", "configuration_rate"]
OF_FRAME = ["frame_placement", "frame_velocity", "frame_acceleration", "frame_jacobian"]


@pytest.mark.parametrize("name", OF_MODEL + OF_FRAME)
def test_finite_differences(case, name: str) -> None:
    """Directional derivative along a random direction of all inputs at once, every output.

    The reference extrapolates two central differences of the function itself, with error of order h^4.
    """
    member = getattr(case.symbolic, name)
    function = member if name in OF_MODEL else member(case.frames[-1])
    values = symbols(function)
    h = ca.SX.sym("h")
    direction = ca.SX.sym("direction", case.model.nv)
    vectors = {key: value for key, value in values.items() if key not in ("q", "fext")}
    moved = {
        **values,
        **{key: value + h * direction for key, value in vectors.items()},
        "q": case.symbolic.integrate(values["q"], h * direction),
    }
    outputs = ca.vertcat(*[ca.vec(output) for output in function.call(list(moved.values()))])
    inputs = {**values, "direction": direction, "h": h}
    along = ca.Function("along", list(inputs.values()), [outputs], list(inputs), ["value"])
    slope = ca.Function("slope", list(inputs.values()), [ca.jtimes(outputs, h, 1)], list(inputs), ["slope"])

    def at(evaluated: ca.Function, step: float) -> np.ndarray:
        return case.evaluate(evaluated, COUNT, h=np.full((1, COUNT), step))[0]

    def central(step: float) -> np.ndarray:
        return (at(along, step) - at(along, -step)) / (2 * step)

    step = 2e-4
    assert_agrees(at(slope, 0.0), list((4 * central(step / 2) - central(step)) / 3), FINITE)
