"""Simulated motions of systems: their values, growth without limit, and what they refuse."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt

S = np.linspace(0.0, 1.0, 21)


def test_the_motion_under_the_middle_of_the_controls() -> None:
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.p["k"] * point.u["u"] - point.x["v"]])
    phase = rt.Phase(
        system,
        duration=rt.between(1.0, 3.0),
        start=rt.State([1.0, 0.0]),
        controls={"u": rt.between(0, 4)},
        parameters={"k": rt.between(1, 2)},
    )
    known = rt.guess.Simulated(2.0).of(phase, 0)
    t = 2.0 * S
    exact = np.column_stack([1.0 + 3.0 * (t - 1.0 + np.exp(-t)), 3.0 * (1.0 - np.exp(-t))])
    assert known.duration == 2.0
    np.testing.assert_allclose(known.states(S), exact, atol=1e-4)
    np.testing.assert_array_equal(known.controls(S), np.full((len(S), 1), 2.0))
    assert known.parameters == {"k": 1.5}


def test_states_that_grow_without_limit_stay_finite() -> None:
    system = rt.System(["x"], ["u"], lambda point: [point.x["x"] ** 2 + point.u["u"]])
    phase = rt.Phase(system, duration=5.0, start=rt.State([1.0]))
    states = rt.guess.Simulated().of(phase, 0).states(S)
    assert np.all(np.isfinite(states)) and states.max() <= 2e6
    np.testing.assert_allclose(states[S < 0.19, 0], 1.0 / (1.0 - 5.0 * S[S < 0.19]), rtol=1e-2)


def test_an_undefined_rate_keeps_the_start() -> None:
    system = rt.System(["x"], ["u"], lambda point: [ca.sqrt(point.x["x"] - 2.0) + point.u["u"]])
    phase = rt.Phase(system, duration=1.0, start=rt.State([1.0]))
    np.testing.assert_array_equal(rt.guess.Simulated().of(phase, 0).states(S), np.ones((len(S), 1)))


def test_robots_are_refused() -> None:
    phase = rt.Phase(rt.load("cartpole"), duration=1.0, start=rt.State(q=0, v=0))
    with pytest.raises(rt.InputError, match="is no System"):
        rt.plan(phase, guess=rt.guess.Simulated())
