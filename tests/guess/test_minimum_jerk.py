"""Minimum jerk: the quintic, its optimality, and guesses that satisfy the dynamics."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName
from robotraj.problem.initial_guess import InitialGuess

S = np.linspace(0.0, 1.0, 41)


def reach(robot: rt.Robot, q: object, duration: object = 2.0, v: object = 0.0) -> rt.Phase:
    return rt.Phase(
        robot,
        duration=duration,
        start=rt.State(q=robot.neutral, v=v),
        end=rt.State(q=q, v=0),
        objective=rt.Effort(),
    )


def balance(phase: rt.Phase, guess: InitialGuess) -> float:
    """Largest torque balance [N m] of an NLP at the guess."""
    nlp = rt.transcription.transcribe(rt.Problem([phase]), rt.Mesh(8), guess)
    names = np.array([entry.name for entry in nlp.rows.entries])[nlp.rows.meaning]
    return float(np.abs(nlp.values(nlp.guess)[names == "torque balance"]).max())


def test_rest_to_rest_is_the_quintic() -> None:
    arm = rt.load("two_link_arm")
    known = rt.guess.MinimumJerk().of(reach(arm, [1.0, -0.5]), 0)
    shape = 10 * S**3 - 15 * S**4 + 6 * S**5
    slope = (30 * S**2 - 60 * S**3 + 30 * S**4) / 2.0
    np.testing.assert_allclose(known.states(S)[:, :2], np.outer(shape, [1.0, -0.5]), atol=1e-12)
    np.testing.assert_allclose(known.states(S)[:, 2:], np.outer(slope, [1.0, -0.5]), atol=1e-12)


def test_it_has_the_least_jerk_from_rest_to_rest() -> None:
    arm = rt.load("two_link_arm")
    curve = rt.guess.MinimumJerk().of(reach(arm, [1.0, 0.0], 1.0), 0).algebraic
    step = 1e-5
    nodes, weights = np.polynomial.legendre.leggauss(12)
    s = 0.5 * (nodes + 1.0)
    jerk = (curve(s + step)[:, 0] - curve(s - step)[:, 0]) / (2 * step)
    # 720 d^2 / T^5 is the least integral of jerk^2 from rest to rest with accelerations of 0 at the ends.
    assert 0.5 * weights @ jerk**2 == pytest.approx(720.0, rel=1e-6)


@pytest.mark.parametrize("name", ["ur5", "two_link_arm", "panda"])
def test_the_guess_satisfies_the_dynamics_at_every_collocation_point(name: str) -> None:
    robot = rt.load(name)
    target = robot.neutral + 0.05
    assert balance(reach(robot, target, 8.0), rt.guess.MinimumJerk()) < 1e-9
    assert balance(reach(robot, target, 8.0), rt.guess.StraightLine()) > 1e-6


def test_damping_and_friction_are_in_the_torques() -> None:
    pendulum = rt.load("pendulum")
    assert pendulum.damping[0] > 0.0
    phase = reach(pendulum, [0.2], 4.0)
    assert balance(phase, rt.guess.MinimumJerk()) < 1e-9


def test_waypoints_are_passed_smoothly_and_given_end_velocities_hold() -> None:
    arm = rt.load("two_link_arm")
    points = [[0.5, 0.2], {"shoulder": 0.1, "elbow": -0.3}]
    fractions = [0.0, 0.3, 0.7, 1.0]
    known = rt.guess.MinimumJerk(points, fractions).of(reach(arm, [1.0, 0.0], 2.0, v=[0.3, -0.1]), 0)
    at = known.states(np.array(fractions))
    np.testing.assert_allclose(at[:, :2], [[0, 0], [0.5, 0.2], [0.1, -0.3], [1.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(at[0, 2:], [0.3, -0.1], atol=1e-12)
    np.testing.assert_allclose(at[-1, 2:], [0.0, 0.0], atol=1e-12)
    near = np.array([0.3 - 1e-9, 0.3 + 1e-9])
    np.testing.assert_allclose(*known.algebraic(near), atol=1e-6)


def test_waypoints_without_fractions_are_spread_by_the_speed_limits() -> None:
    arm = rt.load("two_link_arm", limits={"velocity": 2.0})
    known = rt.guess.MinimumJerk([[0.25, 0.0]]).of(reach(arm, [1.0, 0.0]), 0)
    np.testing.assert_allclose(known.states(np.array([0.25]))[0, 0], 0.25, atol=1e-12)


def test_states_of_a_system_run_on_quintics() -> None:
    system = rt.System(["x", "y"], ["u"], lambda point: [point.u["u"], point.u["u"]])
    phase = rt.Phase(system, duration=1.0, start=rt.State([0, 0]), end=rt.State([2, -1]))
    known = rt.guess.MinimumJerk().of(phase, 0)
    np.testing.assert_allclose(known.states(S), np.outer(10 * S**3 - 15 * S**4 + 6 * S**5, [2, -1]), atol=1e-12)
    through = rt.guess.MinimumJerk([{"x": 5.0, "y": 3.0}], [0, 0.4, 1]).of(phase, 0)
    np.testing.assert_allclose(through.states(np.array([0.4]))[0], [5.0, 3.0], atol=1e-12)


def test_wrong_waypoints_and_fractions_are_named() -> None:
    arm = rt.load("two_link_arm")
    phase = reach(arm, [1.0, 0.0])
    with pytest.raises(InputError, match="waypoint 0"):
        rt.guess.MinimumJerk([[1.0, 2.0, 3.0]]).of(phase, 0)
    with pytest.raises(UnknownName, match="elbo"):
        rt.guess.MinimumJerk([{"elbo": 1.0}]).of(phase, 0)
    with pytest.raises(InputError, match="fractions of MinimumJerk"):
        rt.guess.MinimumJerk([[0.0, 0.0]], [0.0, 1.0]).of(phase, 0)
    with pytest.raises(InputError, match="outside"):
        rt.guess.MinimumJerk(duration=9.0).of(reach(arm, [1.0, 0.0], (0.5, 3.0)), 0)


def test_a_phase_with_added_variables_is_guessed_whole() -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(
        arm,
        duration=5.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=[0.5, 0.0], v=0),
        objective=rt.objectives.TorqueRate() + rt.objectives.Jerk() + rt.objectives.AbsolutePower(),
    )
    for guess in (
        rt.guess.MinimumJerk(),
        rt.guess.StraightLine(),
        rt.guess.Keyframes([0, 1], [rt.State(q=0), rt.State(q=[0.5, 0])]),
    ):
        known = guess.of(phase, 0)
        shapes = [curve(S).shape[1] for curve in (known.states, known.algebraic, known.controls)]
        assert shapes == [len(group) for group in (phase.dae.states, phase.dae.algebraic, phase.dae.controls)]
    torques = rt.guess.MinimumJerk().of(phase, 0).states(S)[:, 4:6]
    assert np.abs(torques).max() > 0.0


def test_accelerations_that_are_states_are_guessed_as_accelerations() -> None:
    phase = reach(rt.load("two_link_arm"), [1.0, -0.5]).with_(objective=rt.objectives.Jerk())
    nlp = rt.transcription.transcribe(rt.Problem([phase]), rt.Mesh(4), rt.guess.MinimumJerk())
    entries = [nlp.variables.entries[k] for k in nlp.variables.meaning]
    chosen = np.array([(e.name, e.label) == ("acceleration", "elbow") for e in entries])
    fractions, values = nlp.variables.fraction[chosen], nlp.guess[chosen]
    # At every point the state and the algebraic variable have the same value.
    inside = [values[fractions == each] for each in np.unique(fractions)[1:-1]]
    assert all(len(each) >= 2 and np.ptp(each) < 1e-9 for each in inside)
    assert np.abs(values).max() > 0.1
