"""The turn of a root in flight, eased into the stances."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.guess.legs.somersault import EASE, Somersault

T = np.linspace(-0.5, 2.0, 2001)


def test_the_angle_grows_from_0_to_a_full_turn_at_a_constant_rate_in_flight() -> None:
    turn = Somersault(np.array([0.0, -1.0, 0.0]), 0.4, 0.9)
    angles = np.array([turn.angle(t) for t in T])
    assert angles[0] == 0.0 and angles[-1] == pytest.approx(2.0 * np.pi)
    rates = np.gradient(angles, T)
    flown = (T > 0.41) & (T < 0.89)
    np.testing.assert_allclose(rates[flown], 2.0 * np.pi / (0.5 * (1.0 + EASE)), rtol=1e-9)
    # The rate is continuous, since the stances accelerate and brake.
    assert np.abs(np.diff(rates)).max() < 0.02 * rates.max()


def test_turns_about_the_axis_end_at_the_negative_quaternion() -> None:
    q = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.5])
    turn = Somersault(np.array([1.0, 0.0, 0.0]), 0.0, 1.0)
    np.testing.assert_allclose(turn.turned(q, 0.5)[3:7], [1.0, 0.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(turn.turned(q, 2.0), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, -1.0, 0.5], atol=1e-15)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_guess_of_a_flip_turns_with_its_bounds(side: float) -> None:
    robot = rt.load("hopper", root="planar")
    problem = rt.gait.flip(robot, axis=(0.0, side, 0.0), feet=["foot"])
    guess = rt.guess.InvertedPendulum().prepared(problem)
    s = np.linspace(0.0, 1.0, 9)
    pitch = np.concatenate([guess.of(phase, i).states(s)[:, 2] for i, phase in enumerate(problem.phases)])
    assert pitch[0] == pytest.approx(0.0, abs=1e-9) and pitch[-1] == pytest.approx(2.0 * np.pi * side)
    flight = pitch[len(s) : 2 * len(s)]
    assert (np.diff(flight) * side > 0.0).all()
