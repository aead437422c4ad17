"""Every function agrees with numeric Pinocchio at 100 random points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

RELATIVE = 1e-9
REFERENCES = [pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, pin.ReferenceFrame.LOCAL]


def assert_agrees(actual: np.ndarray, expected: np.ndarray) -> None:
    """Compare to 1e-9 of the largest entry of each point."""
    expected = np.asarray(expected, dtype=float).reshape(actual.shape)
    scale = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (scale > 0).all(), "a reference of zeros compares nothing"
    assert np.abs((actual - expected) / scale).max() < RELATIVE


def mass_matrix(model: pin.Model, data: pin.Data, q: np.ndarray) -> np.ndarray:
    upper = np.triu(pin.crba(model, data, q))
    return upper + np.triu(upper, 1).T


def center_of_mass(model: pin.Model, data: pin.Data, p: dict[str, Any]) -> tuple[np.ndarray, ...]:
    pin.centerOfMass(model, data, p["q"], p["v"], p["a"])
    return data.com[0].copy(), data.vcom[0].copy(), data.acom[0].copy()


EXPECTED: dict[str, Callable[[pin.Model, pin.Data, dict[str, Any]], Any]] = {
    "forward_dynamics": lambda m, d, p: pin.aba(m, d, p["q"], p["v"], p["tau"], p["forces"]),
    "inverse_dynamics": lambda m, d, p: pin.rnea(m, d, p["q"], p["v"], p["a"], p["forces"]),
    "mass_matrix": lambda m, d, p: mass_matrix(m, d, p["q"]),
    "nonlinear_effects": lambda m, d, p: pin.nonLinearEffects(m, d, p["q"], p["v"]),
    "gravity": lambda m, d, p: pin.computeGeneralizedGravity(m, d, p["q"]),
    "kinetic_energy": lambda m, d, p: pin.computeKineticEnergy(m, d, p["q"], p["v"]),
    "potential_energy": lambda m, d, p: pin.computePotentialEnergy(m, d, p["q"]),
    "center_of_mass": center_of_mass,
    "centroidal_momentum": lambda m, d, p: pin.computeCentroidalMomentum(m, d, p["q"], p["v"]).vector,
    "integrate": lambda m, d, p: pin.integrate(m, p["q"], p["dv"]),
    "difference": lambda m, d, p: pin.difference(m, p["q0"], p["q1"]),
}


@pytest.mark.parametrize("name", EXPECTED)
def test_functions_of_the_model_equal_pinocchios(case, name: str) -> None:
    actual = case.evaluate(getattr(case.symbolic, name))
    rows = []
    for i in range(len(actual[0])):
        value = EXPECTED[name](case.model, case.data, case.point(i))
        rows.append([np.array(part) for part in (value if isinstance(value, tuple) else (value,))])
    for index, output in enumerate(actual):
        assert_agrees(output, np.array([row[index] for row in rows]))


def test_frame_placement(case) -> None:
    for name in case.frames:
        frame = case.model.getFrameId(name)
        positions, rotations = case.evaluate(case.symbolic.frame_placement(name))
        poses = []
        for q in case.points["q"].T:
            pin.forwardKinematics(case.model, case.data, q)
            poses.append(pin.updateFramePlacement(case.model, case.data, frame).copy())
        assert_agrees(positions, np.array([pose.translation for pose in poses]))
        assert_agrees(rotations, np.array([pose.rotation for pose in poses]))


@pytest.mark.parametrize("reference", REFERENCES, ids=str)
def test_frame_motion(case, reference: pin.ReferenceFrame) -> None:
    model, data = case.model, case.data
    for name in case.frames:
        frame = model.getFrameId(name)
        (velocity,) = case.evaluate(case.symbolic.frame_velocity(name, reference))
        (acceleration,) = case.evaluate(case.symbolic.frame_acceleration(name, reference))
        (jacobian,) = case.evaluate(case.symbolic.frame_jacobian(name, reference))
        expected: list[list[np.ndarray]] = [[], [], []]
        for q, v, a in zip(case.points["q"].T, case.points["v"].T, case.points["a"].T, strict=True):
            pin.forwardKinematics(model, data, q, v, a)
            expected[0].append(pin.getFrameVelocity(model, data, frame, reference).vector)
            expected[1].append(pin.getFrameClassicalAcceleration(model, data, frame, reference).vector)
            expected[2].append(pin.computeFrameJacobian(model, data, q, frame, reference))
        for actual, values in zip((velocity, acceleration, jacobian), expected, strict=True):
            assert_agrees(actual, np.array(values))


def test_default_reference_is_local_world_aligned(arm) -> None:
    aligned = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    for method in (arm.symbolic.frame_velocity, arm.symbolic.frame_acceleration, arm.symbolic.frame_jacobian):
        (default,) = arm.evaluate(method("tool0"))
        (named,) = arm.evaluate(method("tool0", aligned))
        (local,) = arm.evaluate(method("tool0", pin.ReferenceFrame.LOCAL))
        assert np.array_equal(default, named)
        assert not np.allclose(default, local)


def test_configuration_rate_is_the_derivative_of_integrate(case) -> None:
    """Richardson's extrapolation of central differences, error of order h^4."""
    (rate,) = case.evaluate(case.symbolic.configuration_rate)

    def central(h: float) -> np.ndarray:
        return np.array(
            [
                (pin.integrate(case.model, q, h * v) - pin.integrate(case.model, q, -h * v)) / (2 * h)
                for q, v in zip(case.points["q"].T, case.points["v"].T, strict=True)
            ]
        )

    h = 1e-3
    assert_agrees(rate, (4 * central(h / 2) - central(h)) / 3)
