"""Simulated motions of systems: their values, growth without limit, and what they refuse."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.guess.default import default_guess

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


def _ship(objective: rt.Lagrange | rt.Mayer) -> rt.Phase:
    """Bryson and Ho (1975), section 2.7: a thrust of half the weight along a path of greatest range in 2 s."""
    system = rt.System(
        ["x", "y", "v"],
        ["c", "s"],
        lambda point: [
            point.x["v"] * point.u["c"],
            point.x["v"] * point.u["s"],
            0.5 - point.u["s"],
        ],
    )
    direction = rt.PathConstraint(lambda point: point.u["c"] ** 2 + point.u["s"] ** 2, 1.0, 1.0, name="unit direction")
    return rt.Phase(system, 2.0, rt.State([0, 0, 0]), rt.State({"y": 0.1}), objective, [direction])


def test_a_system_that_moves_from_a_known_state_to_a_free_end_starts_from_its_simulation() -> None:
    """A straight line stays at x = 0, from where the solver went to the local optimum 0.2523."""
    phase = _ship(rt.Mayer(lambda start, end: -end.x["x"]))
    assert isinstance(default_guess(rt.Problem([phase])), rt.guess.Simulated)
    solution = rt.plan(phase)
    assert abs(solution.objective + 1.71231) < 2e-4  # PSOPT's example bryson_max_range: 1.712314
    assert rt.validate(solution).passed


def test_a_weight_on_the_states_keeps_the_straight_line() -> None:
    """Such a weight keeps a motion near an equilibrium, which may be unstable: a simulation departs from it."""
    phase = _ship(rt.Lagrange(lambda point: point.x["y"] ** 2))
    assert isinstance(default_guess(rt.Problem([phase])), rt.guess.StraightLine)


def test_a_given_end_keeps_the_straight_line() -> None:
    phase = _ship(rt.Mayer(lambda start, end: -end.x["x"]))
    given = phase.with_(end=rt.State({"y": 0.1, "v": 0.4}))
    assert isinstance(default_guess(rt.Problem([given])), rt.guess.StraightLine)
