"""A blend of solutions is their weighted mean, and exact where the equations are linear."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt


def slide(end: float, duration: float = 2.0) -> rt.Phase:
    """Return a block that slides from rest to rest with least effort."""
    return rt.Phase(rt.load("block"), duration, rt.State(q=0, v=0), rt.State(q=end, v=0), rt.Effort(), limits=None)


@pytest.fixture(scope="module")
def slides() -> list[rt.Solution]:
    return [rt.plan(slide(end), mesh=rt.Mesh(5)) for end in (1.0, 3.0)]


def test_the_blend_of_optimal_motions_of_a_linear_system_is_optimal(slides: list[rt.Solution]) -> None:
    """From rest to rest over L, q = L (3 s^2 - 2 s^3) and tau = m L (6 - 12 s) / T^2, which are linear in L."""
    phase, fractions = slide(1.5), np.linspace(0.0, 1.0, 9)
    guess = rt.guess.Blend(slides, [0.75, 0.25]).of(phase, 0)
    assert guess.duration == pytest.approx(2.0)
    np.testing.assert_allclose(guess.states(fractions)[:, 0], 1.5 * (3 * fractions**2 - 2 * fractions**3), atol=1e-6)
    mass = rt.load("block").mass
    np.testing.assert_allclose(guess.controls(fractions)[:, 0], mass * 1.5 * (6 - 12 * fractions) / 4, atol=1e-5)


def test_a_plan_from_a_blend_ends_at_the_optimum(slides: list[rt.Solution]) -> None:
    """The least effort over L in T is 12 m^2 L^2 / T^3."""
    found = rt.plan(slide(1.5), mesh=rt.Mesh(5), guess=rt.guess.Blend(slides, [0.75, 0.25]))
    assert found.objective == pytest.approx(12 * rt.load("block").mass ** 2 * 1.5**2 / 8, rel=1e-6)


def test_quaternions_of_either_sign_blend_to_one_of_length_1_between_them() -> None:
    """The mean of two turns about one axis is the turn by the mean angle."""
    robot = rt.load("solo12", root="floating")
    motions = []
    for angle, sign in ((0.2, 1.0), (0.6, -1.0)):
        q = np.array(robot.neutral)
        q[3:7] = sign * np.array([0.0, 0.0, np.sin(angle / 2), np.cos(angle / 2)])
        rest = rt.State(q=q, v=0)
        motions.append(rt.plan(rt.Phase(robot, 0.5, rest, objective=rt.Effort()), mesh=rt.Mesh(2)))
    phase = motions[0].phases[0].phase
    start = rt.guess.Blend(motions, [0.5, 0.5]).of(phase, 0).states(np.zeros(1))[0]
    np.testing.assert_allclose(start[3:7], [0, 0, np.sin(0.2), np.cos(0.2)], atol=1e-9)


@pytest.mark.parametrize("weights", [[1.0], [0.5, 0.6], [[0.5, 0.5]], [np.nan, 1.0]])
def test_weights_are_one_for_each_solution_with_the_sum_1(slides: list[rt.Solution], weights: object) -> None:
    with pytest.raises(rt.InputError, match="weight"):
        rt.guess.Blend(slides, weights)  # type: ignore[arg-type]
