"""Minimum time with a little effort: the bound on the time it costs."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import robotraj as rt

FASTEST = 2.0 * np.sqrt(10.0)
"""1 kg over 10 m with |F| <= 1 N: thrust half the way, brake the other half [s]."""


@pytest.mark.parametrize("weight", [0.3, 0.03, 0.003])
def test_a_little_effort_costs_no_more_time_than_its_bound(weight: float) -> None:
    block = rt.load("block")
    phase = rt.Phase(
        block,
        duration=(1.0, 20.0),
        start=rt.State(q=0, v=0),
        end=rt.State(q=10, v=0),
        objective=rt.Duration() + weight * rt.Effort(),
    )
    solution = rt.plan(phase, tolerance=1e-6)
    effort = (solution.objective - solution.duration) / weight
    # The fastest motion has an effort of F^2 T.
    assert FASTEST - 1e-6 <= solution.duration <= FASTEST + weight * (FASTEST - effort) + 1e-6


def test_the_torques_are_those_of_pontryagins_principle() -> None:
    # H = 1 + w u^2 + lambda_1 v + lambda_2 u: u = clip(linear in t), antisymmetric about the middle.
    weight = 1.0
    phase = rt.Phase(
        rt.load("block"),
        duration=(1.0, 20.0),
        start=rt.State(q=0, v=0),
        end=rt.State(q=10, v=0),
        limits=None,
        objective=rt.Duration() + weight * rt.Effort(),
    )
    solution = rt.plan(phase, mesh=rt.Mesh(10))
    # Without limits effort is 12 d^2 / T^3, so that T^4 = 36 w d^2.
    duration = (36.0 * weight * 100.0) ** 0.25
    assert solution.duration == pytest.approx(duration, rel=1e-7)
    times = np.linspace(0.0, duration, 20)
    expected = 60.0 / duration**2 * (1.0 - 2.0 * times / duration)
    np.testing.assert_allclose(solution.at(np.minimum(times, solution.duration)).tau[:, 0], expected, atol=1e-6)


def test_a_fixed_duration_that_is_minimised_is_told() -> None:
    robot = rt.load("block")
    ends = rt.State(q=0, v=0), rt.State(q=1, v=0)
    mesh = rt.Mesh(4)
    with pytest.warns(UserWarning, match=r"duration alone, which is fixed at 2 s.*duration=\(0.2, 10\)"):
        rt.plan(rt.Phase(robot, 2.0, *ends, rt.Duration()), mesh)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.plan(rt.Phase(robot, (0.5, 20.0), *ends, rt.Duration()), mesh)
        rt.plan(rt.Phase(robot, 2.5, *ends, rt.Duration() + rt.Effort()), mesh)
