"""Curves through configurations: they interpolate, their velocities and accelerations are derivatives, turns count."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import scipy

import robotraj as rt
from robotraj.robot import tangent
from robotraj.robot.chart import Chart, coordinate_difference

STEP = 1e-5


@pytest.fixture(scope="module")
def model():
    return rt.load("cartpole", root="floating").model


@pytest.fixture(scope="module")
def keys(model):
    rng = np.random.default_rng(5)
    keys = [pin.neutral(model)]
    for _ in range(3):
        keys.append(pin.integrate(model, keys[-1], rng.normal(size=model.nv)))
    return np.array(keys)


@pytest.fixture(scope="module")
def curve(model, keys):
    chart = Chart.around(model, keys[0])
    return chart, scipy.interpolate.CubicSpline(np.linspace(0, 1, 4), chart.coordinates(keys))


def test_keys_are_met_with_their_signs(model, keys):
    mixed = keys.copy()
    mixed[2, 3:7] *= -1
    chart = Chart.around(model, mixed[0])
    np.testing.assert_allclose(chart.positions(chart.coordinates(mixed)), mixed, atol=1e-15)


def test_velocities_and_accelerations_are_the_curves_own(model, curve):
    chart, y = curve
    t = np.linspace(0.05, 0.95, 13)

    def v(at):
        return chart.velocities(y(at), y(at, 1))

    gaps = tangent.difference(model, chart.positions(y(t - STEP)), chart.positions(y(t + STEP)))
    np.testing.assert_allclose(v(t), gaps / (2 * STEP), atol=1e-7)
    expected = (v(t + STEP) - v(t - STEP)) / (2 * STEP)
    np.testing.assert_allclose(chart.accelerations(y(t), y(t, 1), y(t, 2)), expected, atol=1e-6)


def test_slopes_invert_velocities(curve):
    chart, y = curve
    for t in (0.0, 0.4, 1.0):
        v = chart.velocities(y(t)[None], y(t, 1)[None])[0]
        np.testing.assert_allclose(chart.slopes(y(t), v), y(t, 1), atol=1e-12)


def test_a_line_turns_at_one_rate_and_runs_straight(model, keys):
    chart = Chart.around(model, keys[0])
    start, end = chart.coordinates(keys[[0, 3]])
    s = np.linspace(0, 1, 9)[:, None]
    q = chart.positions(start + s * (end - start))
    slerp = scipy.spatial.transform.Slerp([0, 1], scipy.spatial.transform.Rotation.from_quat(keys[[0, 3], 3:7]))
    np.testing.assert_allclose(abs(np.sum(slerp(s[:, 0]).as_quat() * q[:, 3:7], axis=1)), 1.0, atol=1e-14)
    np.testing.assert_allclose(q[:, :3], keys[0, :3] + s * (keys[3, :3] - keys[0, :3]), atol=1e-15)


def test_turns_are_counted_through_keys(model):
    angles = np.linspace(0, 5 * np.pi, 9)
    keys = np.tile(pin.neutral(model), (9, 1))
    keys[:, 3:7] = np.column_stack([np.zeros(9), np.sin(angles / 2), np.zeros(9), np.cos(angles / 2)])
    turns = Chart.around(model, keys[0]).coordinates(keys)[:, 3:6]
    np.testing.assert_allclose(turns, np.outer(angles, [0, 1, 0]), atol=1e-12)


def test_the_negative_quaternion_is_a_somersault_away(model):
    first = pin.neutral(model)
    last = first.copy()
    last[3:7] *= -1
    np.testing.assert_allclose(coordinate_difference(model, first, last), [0, 0, 0, 0, 2 * np.pi, 0, 0, 0], atol=1e-15)
    np.testing.assert_array_equal(coordinate_difference(model, first, first), np.zeros(8))


def test_without_a_floating_root_coordinates_are_positions():
    robot = rt.load("cartpole", root="planar")
    y, rate, second = np.random.default_rng(1).normal(size=(3, 6, 5))
    chart = Chart.around(robot.model, robot.neutral)
    for same, of in (
        (chart.coordinates(y), y),
        (chart.positions(y), y),
        (chart.velocities(y, rate), rate),
        (chart.accelerations(y, rate, second), second),
        (chart.slopes(y[0], rate[0]), rate[0]),
    ):
        np.testing.assert_array_equal(same, of)
