"""Guesses: lines, keyframes, earlier solutions."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
S = np.linspace(0, 1, 5)


def cartpole(**more: object) -> rt.Phase:
    given = {"duration": 2.0, "start": rt.State(q=[0, 0], v=0), "end": rt.State(q=[1, np.pi], v=0)}
    return rt.Phase(rt.load("cartpole"), **(given | more))


def test_a_straight_line_of_a_system_joins_the_ends() -> None:
    phase = rt.Phase(BLOCK, 2.0, rt.State([0, 1]), rt.State([4, None]))
    guess = rt.guess.StraightLine().of(phase, 0)
    np.testing.assert_allclose(guess.states(S), np.column_stack([4 * S, np.ones(5)]))
    np.testing.assert_array_equal(guess.controls(S), np.zeros((5, 1)))


def test_velocities_of_a_straight_line_are_its_rates() -> None:
    guess = rt.guess.StraightLine().of(cartpole(), 0)
    states = guess.states(S)
    np.testing.assert_allclose(states[:, :2], S[:, None] * [1, np.pi])
    np.testing.assert_allclose(states[1:-1, 2:], [[0.5, np.pi / 2]] * 3)
    np.testing.assert_array_equal(states[[0, -1], 2:], 0)
    assert guess.algebraic(S).shape == (5, 2)


def test_free_ends_are_taken_from_the_other_end_or_the_middle_of_their_bounds() -> None:
    phase = rt.Phase(BLOCK, 2.0, rt.State({"x": rt.between(1, 3)}), rt.State({"v": 7}))
    np.testing.assert_allclose(rt.guess.StraightLine().of(phase, 0).states(S), [[2, 7]] * 5)


def test_the_guessed_duration_allows_the_speed_limits() -> None:
    slow = rt.load("cartpole").limits.with_(velocity=0.5)
    guess = rt.guess.StraightLine().of(cartpole(duration=(0.1, 60), limits=slow), 0)
    assert guess.duration == pytest.approx(1.5 * np.pi / 0.5)


def test_keyframes_of_a_system_are_joined_by_lines() -> None:
    phase = rt.Phase(BLOCK, 2.0)
    guess = rt.guess.Keyframes([0, 0.5, 1], [rt.State([0, 0]), rt.State([1, 2]), rt.State([0, 4])]).of(phase, 0)
    np.testing.assert_allclose(guess.states(S), [[0, 0], [0.5, 1], [1, 2], [0.5, 3], [0, 4]])


def test_keyframes_of_a_robot_pass_the_poses_without_overshoot() -> None:
    poses = [[0, 0], [0.5, 2], [0.2, 3], [1, np.pi]]
    fractions = [0, 0.3, 0.6, 1]
    guess = rt.guess.Keyframes(fractions, [rt.State(q=pose) for pose in poses]).of(cartpole(), 0)
    np.testing.assert_allclose(guess.states(np.array(fractions))[:, :2], poses, atol=1e-15)
    s, h = np.linspace(0.01, 0.99, 40), 1e-6
    duration = 2.0
    rates = (guess.states(s + h) - guess.states(s - h)) / (2 * h * duration)
    np.testing.assert_allclose(guess.states(s)[:, 2:], rates[:, :2], atol=1e-6)
    np.testing.assert_allclose(guess.algebraic(s), rates[:, 2:], atol=1e-4)
    dense = guess.states(np.linspace(0, 1, 1001))[:, :2]
    np.testing.assert_allclose(dense.max(axis=0), [1, np.pi], rtol=1e-15)
    assert dense.min() == 0


def test_parameters_start_in_the_middle_of_their_bounds() -> None:
    bounds = {"a": rt.between(1, 3), "b": rt.between(2, None), "c": None, "d": 5.0}
    phase = rt.Phase(BLOCK, 1.0, parameters=bounds)
    assert rt.guess.StraightLine().of(phase, 0).parameters == {"a": 2.0, "b": 2.0, "c": 1.0, "d": 5.0}


@pytest.mark.parametrize(
    "scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(points=3), rt.schemes.GaussLegendre(points=2)], ids=repr
)
def test_a_solution_as_guess_on_its_own_mesh_is_that_solution(scheme: rt.HermiteSimpson) -> None:
    """Also where controls jump at knots: one-sided values are sampled."""
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2 + point.x["x"] ** 4)
    phase = rt.Phase(BLOCK, (1, 2), rt.State([0, 0]), rt.State([1, 0]), cost, controls={"u": rt.between(-4, 5)})
    mesh = rt.Mesh(7, scheme)
    solution = rt.plan(phase, mesh)
    nlp = rt.transcription.transcribe(solution.problem, mesh, rt.guess.FromSolution(solution))
    layout = nlp.layouts[0]
    trajectory = solution.phases[0].trajectory
    np.testing.assert_allclose(nlp.guess[layout.knots], trajectory.x(solution.phases[0].knots), atol=1e-9)
    for interval, values in zip(layout.intervals, trajectory.u.values, strict=True):
        np.testing.assert_allclose(nlp.guess[interval.controls], values, atol=1e-6)
    assert np.max(np.abs(nlp.values(nlp.guess))) < 1e-6


def test_a_phase_used_twice_is_guessed_by_its_index() -> None:
    hop = rt.Phase(BLOCK, (0.5, 2), states={"x": rt.between(0, 9)}, objective=rt.Duration(), name="hop")
    first = rt.AtStart(rt.PathConstraint(lambda point: point.x["x"] + point.t, lower=0, upper=9))
    other = rt.Phase(BLOCK, (0.5, 2), constraints=[first], objective=rt.Duration())
    seen = []

    class Spy(rt.guess.StraightLine):
        def of(self, phase: rt.Phase, index: int) -> object:
            seen.append(index)
            return super().of(phase, index)

    rt.transcription.transcribe(rt.Problem([hop, other, hop]), rt.Mesh(2), Spy())
    assert seen == [0, 1, 2]


def test_a_solution_of_another_system_is_refused() -> None:
    solution = rt.plan(rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort()), rt.Mesh(4))
    pendulum = rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    with pytest.raises(rt.InputError, match="none of the states of phase 'phase': it is a motion of x, v, not of q"):
        rt.plan(pendulum, rt.Mesh(4), guess=solution)


def test_free_phases_keep_the_state_in_which_the_phase_before_ends() -> None:
    """Zero would be the centre of the Earth for a rocket, where its gravity is singular."""
    falling = rt.System(["r", "m"], ["u"], lambda point: [point.u["u"] - 1 / point.x["r"] ** 2, -0.1])
    first = rt.Phase(falling, 1.0, rt.State([1, 5]), rt.State({"r": 2}))
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    rest = [rt.Phase(falling, 1.0, objective=effort), rt.Phase(falling, 1.0, end=rt.State({"r": 4}), objective=effort)]
    links = [rt.links.Jump(0, 1, jumps={"m": -3.0}), rt.Continuity(1, 2)]
    problem = rt.Problem([first, *rest], links)
    known = rt.guess.StraightLine().prepared(problem)
    states = [known.of(phase, i).states(np.array([0.0, 1.0])) for i, phase in enumerate(problem.phases)]
    assert np.array(states).tolist() == [[[1, 5], [2, 5]], [[2, 2], [2, 2]], [[4, 2], [4, 2]]]
    assert rt.plan(problem, rt.Mesh(5)).success
