"""Velocities of many configurations with a quaternion agree with Pinocchio's integrate and difference."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.point import symbolic_model
from robotraj.robot import tangent


@pytest.fixture(scope="module")
def flying():
    return rt.load("cartpole", root="floating")


def motion(model, count=20):
    rng = np.random.default_rng(3)
    v = rng.normal(size=(count, model.nv))
    q = np.array([pin.integrate(model, pin.neutral(model), 2.0 * step) for step in rng.normal(size=v.shape)])
    return q, v


def test_rates_are_those_of_integration(flying):
    model, h = flying.model, 1e-6
    q, v = motion(model)
    moved = [np.array([pin.integrate(model, a, sign * h * b) for a, b in zip(q, v, strict=True)]) for sign in (1, -1)]
    np.testing.assert_allclose(tangent.rates(model, q, v), (moved[0] - moved[1]) / (2 * h), atol=1e-8)
    np.testing.assert_allclose(tangent.rates(model, q[0], v[0]), tangent.rates(model, q, v)[0], rtol=1e-15)
    symbolic = np.array(symbolic_model(flying).configuration_rate(q[0], v[0])).ravel()
    np.testing.assert_allclose(tangent.rates(model, q[0], v[0]), symbolic, atol=1e-14)


def test_rates_are_linear_in_velocities(flying):
    model = flying.model
    for q, v in zip(*motion(model), strict=True):
        q[3:7] *= 1.3
        np.testing.assert_allclose(tangent.rate_matrix(model, q) @ v, tangent.rates(model, q, v), atol=1e-14)
    fixed = rt.load("cartpole").model
    np.testing.assert_array_equal(tangent.rate_matrix(fixed, np.zeros(2)), np.eye(2))


def test_velocities_invert_rates_whatever_the_length_of_the_quaternion(flying):
    model = flying.model
    q, v = motion(model)
    np.testing.assert_allclose(tangent.velocities(model, q, tangent.rates(model, q, v)), v, atol=1e-13)
    longer = q.copy()
    longer[:, 3:7] *= 1.7
    rate = tangent.rates(model, longer, v)
    np.testing.assert_allclose(tangent.velocities(model, longer, rate), v, atol=1e-13)
    growing = rate.copy()
    growing[:, 3:7] += 0.9 * longer[:, 3:7]
    np.testing.assert_allclose(tangent.velocities(model, longer, growing), v, atol=1e-13)


def test_difference_is_pinocchios_row_by_row(flying):
    model = flying.model
    q, _ = motion(model)
    for a, b, gap in zip(q[:-1], q[1:], tangent.difference(model, q[:-1], q[1:]), strict=True):
        np.testing.assert_allclose(gap, pin.difference(model, a, b), atol=1e-13)
    np.testing.assert_array_equal(tangent.difference(model, q[0], q), tangent.difference(model, q[:1], q))


def test_normalising_changes_quaternions_alone(flying):
    q, _ = motion(flying.model)
    scaled = q.copy()
    scaled[:, 3:7] *= 3.0
    np.testing.assert_allclose(tangent.normalised(flying.model, scaled), q, atol=1e-15)


def test_without_a_floating_root_velocities_are_rates():
    model = rt.load("cartpole", root="planar").model
    q, v = np.random.default_rng(0).normal(size=(2, 4, 5))
    for same in (tangent.rates(model, q, v), tangent.velocities(model, q, v)):
        np.testing.assert_array_equal(same, v)
    np.testing.assert_array_equal(tangent.normalised(model, q), q)
    np.testing.assert_array_equal(tangent.difference(model, q, v), v - q)
