"""Sizes of variables and rows follow from the motion, in whatever unit it is written."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.sizes.motion_sizes import MotionSizes, same_variables

TIMES = np.linspace(0.0, 2.0, 201)
NOTHING = np.zeros(0)


def carriage(unit: float, *constraints: rt.PathConstraint) -> rt.Phase:
    """A carriage whose lengths are written in ``1 / unit`` m."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    return rt.Phase(system, 2.0, constraints=list(constraints))


def swing(unit: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Positions that end 3 m away, and their derivatives: t, x, z, u."""
    s = TIMES / 2.0
    x = 3.0 * (3 * s**2 - 2 * s**3)
    v, u = np.gradient(x, TIMES), np.gradient(np.gradient(x, TIMES), TIMES)
    return TIMES, unit * np.column_stack([x, v]), np.zeros((len(TIMES), 0)), unit * u[:, None]


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("factor", [1e-6, 1.0, 1e6])
def test_a_row_is_as_large_as_its_slopes_times_the_sizes_of_its_variables(unit: float, factor: float) -> None:
    """k (v u - x^2) is changed by k (|u| s_v + |v| s_u + 2 |x| s_x)."""
    row = rt.PathConstraint(lambda p: factor * (p.x["v"] * p.u["u"] - p.x["x"] ** 2), upper=0.0)
    phase, motion = carriage(unit, row), swing(unit)
    sizes = MotionSizes.of(phase.rows, *motion, NOTHING)
    assert sizes.x == pytest.approx(np.ptp(motion[1], axis=0), rel=1e-3)
    at = [20, 77, 150]
    t, x, z, u = (each[at] for each in motion)
    found = sizes.changes(phase.rows.path, phase.rows.sample, t, x, z, u, NOTHING)[:, 0]
    by_hand = np.abs(u[:, 0]) * sizes.x[1] + np.abs(x[:, 1]) * sizes.u[0] + 2.0 * np.abs(x[:, 0]) * sizes.x[0]
    assert found == pytest.approx(factor * by_hand, rel=1e-3)


def test_where_the_gradient_is_zero_the_bend_of_a_row_remains() -> None:
    """At its middle a circle of radius 0.01 has no slope; (s STEP)^2 / STEP of both sides is left."""
    phase, motion = carriage(1.0, rt.PathConstraint(lambda p: p.x["x"] ** 2, lower=1e-4)), swing(1.0)
    sizes = MotionSizes.of(phase.rows, *motion, NOTHING)
    start = (each[:1] for each in motion)
    (found,) = sizes.changes(phase.rows.path, phase.rows.sample, *start, NOTHING)[:, 0]
    assert 0.0 < found < 1e-2


def test_a_control_is_at_least_as_large_as_what_moves_a_state_by_its_size() -> None:
    """Coasting at 1.5 changes no speed: a thousandth of it is its size, and half of that the control's, in 2 s."""
    coasting = np.column_stack([1.5 * TIMES, np.full(len(TIMES), 1.5)])
    noise = 1e-12 * np.sin(TIMES)[:, None]
    sizes = MotionSizes.of(carriage(1.0).rows, TIMES, coasting, np.zeros((len(TIMES), 0)), noise, NOTHING)
    assert sizes.u[0] == pytest.approx(0.5e-3 * 1.5)


def test_phases_with_the_same_variables_share_the_larger_sizes() -> None:
    moving, still = (MotionSizes.of(carriage(1.0).rows, *motion, NOTHING) for motion in (swing(1.0), swing(1e-9)))
    joined = still.joined(moving)
    assert np.array_equal(joined.x, moving.x) and np.array_equal(joined.u, moving.u)
    other = rt.Phase(rt.System(["y"], ["u"], lambda point: [point.u["u"]]), 2.0)
    first, second = carriage(1.0), carriage(1.0)
    assert same_variables([first, other, second], first) == [0, 2]
