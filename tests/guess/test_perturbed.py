"""Random variations: seeded, smooth, inside the limits, through the given ends."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

S = np.linspace(0.0, 1.0, 201)


def swing(**changes: object) -> rt.Phase:
    given = dict(duration=2.0, start=rt.State(q=0, v=0), end=rt.State(q=[1.0, np.pi], v=0), objective=rt.Effort())
    return rt.Phase(rt.load("cartpole"), **(given | changes))


def test_the_same_seed_gives_the_same_guess_and_others_do_not() -> None:
    phase = swing()
    one, same, other = (rt.guess.Perturbed(rt.guess.StraightLine(), (3, i)).of(phase, 0).states(S) for i in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.1


def test_no_spread_is_the_guess_itself() -> None:
    phase = swing(duration=(1.0, 4.0))
    known, base = (
        g.of(phase, 0) for g in (rt.guess.Perturbed(rt.guess.MinimumJerk(), (0,), 0.0), rt.guess.MinimumJerk())
    )
    assert known.duration == base.duration
    np.testing.assert_allclose(known.states(S), base.states(S), atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_bounds_hold_and_velocities_are_the_rates_of_positions(seed: int) -> None:
    phase = swing(duration=(1.0, 4.0))
    known = rt.guess.Perturbed(rt.guess.MinimumJerk(), (seed,), 0.3).of(phase, 0)
    states = known.states(S)
    limits = phase.robot.limits
    assert np.all(states[:, :2] >= limits.position_lower) and np.all(states[:, :2] <= limits.position_upper)
    assert 1.0 <= known.duration <= 4.0
    np.testing.assert_allclose(states[[0, -1], :2], [[0, 0], [1.0, np.pi]], atol=1e-9)
    inside = np.all(np.abs(states[:, :2]) < limits.position_upper - 1e-6, axis=1)
    step = 1e-6
    slope = (known.states(S + step) - known.states(S - step))[:, :2] / (2 * step * known.duration)
    np.testing.assert_allclose(states[inside, 2:], slope[inside], atol=1e-5)


def test_controls_of_a_system_and_free_parameters_vary_inside_their_bounds() -> None:
    system = rt.System(["x"], ["u"], lambda point: [point.p["k"] * point.u["u"]])
    phase = rt.Phase(
        system,
        duration=1.0,
        start=rt.State([0.0]),
        end=rt.State([1.0]),
        controls={"u": rt.between(-1, 1)},
        parameters={"k": rt.between(2.0, 3.0)},
    )
    guesses = [rt.guess.Perturbed(rt.guess.StraightLine(), (i,), 1.0).of(phase, 0) for i in range(5)]
    controls = np.array([g.controls(S) for g in guesses])
    assert np.abs(controls).max() <= 1.0
    assert np.ptp(controls[:, 100], axis=0).max() > 0.1
    values = [g.parameters["k"] for g in guesses]
    assert 2.0 <= min(values) < max(values) <= 3.0


LINE = rt.guess.StraightLine()


@pytest.mark.parametrize(
    "given", [(3, 0), (LINE, -1), (LINE, (1, 0.5)), (LINE, 0, -1.0), (LINE, 0, np.nan), (LINE, 0, 20.0)]
)
def test_what_cannot_be_drawn_is_refused_when_it_is_made(given: tuple[object, ...]) -> None:
    with pytest.raises(rt.InputError, match="Perturbed"):
        rt.guess.Perturbed(*given)
