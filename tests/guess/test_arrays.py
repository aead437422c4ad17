"""Guesses from arrays over time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
PULLED = rt.System(
    ["x", "v"],
    ["u"],
    lambda point: [point.x["v"], point.z["pull"]],
    algebraic=["pull"],
    residual=lambda point: [point.z["pull"] - point.u["u"]],
)
TIMES = np.linspace(3.0, 5.0, 41)
S = np.linspace(0, 1, 41)


def pushed(**more: Any) -> rt.Phase:
    given = {"duration": 2.0, "start": rt.State([0, 0]), "end": rt.State([1, 0]), "objective": rt.Effort()}
    return rt.Phase(BLOCK, **(given | more))


def swung(**more: Any) -> rt.Phase:
    given = {
        "duration": (0.5, 4.0),
        "start": rt.State(q=[0, 0], v=0),
        "end": rt.State(q=[1, np.pi], v=0),
        "objective": rt.Effort() + 10 * rt.Duration(),
    }
    return rt.Phase(rt.load("cartpole"), **(given | more))


def floating(**more: Any) -> rt.Phase:
    return rt.Phase(rt.load("pendulum", root="floating"), 2.0, **more)


def sampled(solution: rt.Solution) -> rt.Guess:
    """The solution of a robot as arrays at its knots and points."""
    part = solution.phases[0]
    times = np.union1d(part.knots, part.points)
    sample = solution.at(times)
    return rt.Guess(times, q=sample.q, v=sample.v, a=sample.a, tau=sample.tau)


def test_arrays_of_a_system_are_interpolated_and_the_times_give_the_duration() -> None:
    table = np.column_stack([S**2, 2 * S])
    guess = rt.Guess(TIMES, states=table, controls=np.sin(S)).of(pushed(duration=(1, 3)), 0)
    assert guess.duration == pytest.approx(2.0)
    np.testing.assert_allclose(guess.states(S), table, atol=1e-12)
    np.testing.assert_allclose(guess.controls(S)[:, 0], np.sin(S), atol=1e-12)
    np.testing.assert_allclose(guess.states(np.array([0.312]))[0], [0.312**2, 0.624], atol=1e-4)


def test_values_by_name_leave_the_others_on_the_straight_line() -> None:
    guess = rt.Guess(TIMES, states={"v": 0.5}, controls={"u": S}).of(pushed(), 0)
    np.testing.assert_allclose(guess.states(S), np.column_stack([S, np.full(41, 0.5)]), atol=1e-12)
    np.testing.assert_allclose(guess.controls(S)[:, 0], S)


def test_algebraic_variables_and_parameters_are_given_by_name() -> None:
    bounds = {"mass": rt.between(1, 3), "length": rt.between(1, 2)}
    phase = rt.Phase(PULLED, 2.0, parameters=bounds)
    guess = rt.Guess(TIMES, algebraic={"pull": S}, parameters={"mass": 1.5}).of(phase, 0)
    np.testing.assert_allclose(guess.algebraic(S)[:, 0], S)
    assert guess.parameters == {"mass": 1.5, "length": 1.5}


def test_velocities_accelerations_and_torques_follow_from_positions() -> None:
    robot = rt.load("ur5")
    phase = rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=1, v=0))
    times = np.linspace(0, 2, 401)
    amplitudes = np.linspace(0.2, 1.0, robot.nv)
    angle = 0.5 * np.pi * times[:, None]
    q, v, a = (
        amplitudes * np.sin(angle),
        amplitudes * 0.5 * np.pi * np.cos(angle),
        -0.25 * np.pi**2 * amplitudes * np.sin(angle),
    )
    guess = rt.Guess(times, q=q).of(phase, 0)
    inner = np.linspace(0.05, 0.95, 91)
    rows = np.round(inner * 400).astype(int)
    states = guess.states(inner)
    np.testing.assert_allclose(states[:, :6], q[rows], atol=1e-6)
    np.testing.assert_allclose(states[:, 6:], v[rows], atol=1e-3)
    np.testing.assert_allclose(guess.algebraic(inner), a[rows], atol=2e-2)
    data = robot.model.createData()
    torques = [pin.rnea(robot.model, data, *row) + robot.dissipation(row[1]) for row in zip(q, v, a, strict=True)]
    np.testing.assert_allclose(guess.controls(inner), np.array(torques)[rows], atol=0.1)


def test_positions_by_joint_keep_the_given_velocities() -> None:
    phase = swung(duration=2.0)
    _, pole = phase.robot.position_names
    guess = rt.Guess(TIMES, q={pole: 3 * S}, v={pole: 1.5}).of(phase, 0)
    np.testing.assert_allclose(
        guess.states(S), np.column_stack([S, 3 * S, np.full(41, 0.5), np.full(41, 1.5)]), atol=1e-9
    )


def test_arrays_of_a_solution_are_a_warm_start() -> None:
    phase, mesh = swung(), rt.Mesh(30)
    cold = rt.plan(phase, mesh)
    again = rt.plan(phase, mesh, sampled(cold))
    assert again.objective == pytest.approx(cold.objective, rel=1e-7)
    assert again.iterations < cold.iterations


@pytest.mark.parametrize("name", ["cartpole", "ur5"])
def test_arrays_of_a_solution_start_where_the_solution_itself_does(name: str) -> None:
    robot = rt.load(name)
    end = rt.State(q=[1, np.pi] if name == "cartpole" else [1, -1, 1, 0, 0, 0], v=0)
    solution = rt.plan(rt.Phase(robot, 2.0, rt.State(q=0, v=0), end, rt.Effort()), rt.Mesh(10))
    known, arrays = (
        rt.transcription.transcribe(solution.problem, rt.Mesh(10), guess).guess
        for guess in (rt.guess.FromSolution(solution), sampled(solution))
    )
    np.testing.assert_allclose(arrays, known, rtol=1e-6, atol=1e-6)


def test_quaternions_follow_the_turn_whatever_their_signs() -> None:
    angle = np.linspace(0.0, 1.8 * np.pi, 41)
    q = np.zeros((41, 8))
    q[:, 5], q[:, 6] = np.sin(0.5 * angle), np.cos(0.5 * angle)
    signs = np.where(np.arange(41) % 3 == 1, -1.0, 1.0)
    flipped = q.copy()
    flipped[:, 3:7] *= signs[:, None]
    guess = rt.Guess(TIMES, q=flipped).of(floating(start=rt.State(q=q[0])), 0)
    dense = np.linspace(0, 1, 201)
    states = guess.states(dense)
    half = 0.9 * np.pi * dense
    np.testing.assert_allclose(states[:, 5:7], np.column_stack([np.sin(half), np.cos(half)]), atol=1e-9)
    np.testing.assert_allclose(states[:, 8 + 5], 0.9 * np.pi, atol=1e-9)


def test_contacts_without_forces_carry_the_robot() -> None:
    robot = rt.load("solo12", root="floating")
    feet = [rt.PointContact(foot) for foot in rt.gait.feet_of(robot, None)]
    phase = rt.Phase(robot, 1.0, contacts=feet)
    q = np.tile(rt.gait.stand(robot), (5, 1))
    guess = rt.Guess(np.linspace(0, 1, 5), q=q, v=0).of(phase, 0)
    names = [variable.name for variable in phase.dae.algebraic]
    up = [i for i, name in enumerate(names) if name.endswith(".z") and not name.startswith("a.")]
    weight = 9.81 * pin.computeTotalMass(robot.model)
    np.testing.assert_allclose(guess.algebraic(S)[:, up].sum(axis=1), weight, rtol=1e-6)
    forces = {foot.frame: np.column_stack([np.zeros((5, 2)), np.full(5, 0.25 * weight)]) for foot in feet}
    known = rt.Guess(np.linspace(0, 1, 5), q=q, v=0, forces=forces).of(phase, 0)
    np.testing.assert_allclose(known.algebraic(S)[:, up], 0.25 * weight)
    np.testing.assert_allclose(known.controls(S), guess.controls(S), atol=0.2)


def test_several_phases_take_one_guess_each() -> None:
    first, second = pushed(end=None, name="first"), pushed(start=None, name="second")
    problem = rt.Problem([first, second], [rt.Continuity(0, 1)])
    guesses = [rt.Guess([0, 2], states=[[0, 0], [0.5, 0.5]]), rt.Guess([2, 4], states=[[0.5, 0.5], [1, 0]])]
    assert rt.plan(problem, rt.Mesh(5), guesses).success
    mixed = [guesses[0], rt.guess.StraightLine()]
    assert rt.plan(problem, rt.Mesh(5), mixed).success
    with pytest.raises(rt.InputError, match=r"has 2 phases \('first', 'second'\), and guess= describes 1"):
        rt.plan(problem, rt.Mesh(5), guesses[0])


def test_keyframes_take_controls_and_velocities() -> None:
    states = [rt.State(q=[0, 0], v=0), rt.State(q=[0.5, 2], v=[0.7, None]), rt.State(q=[1, np.pi], v=0)]
    keyframes = rt.guess.Keyframes([0, 0.5, 1], states, controls=[[0.0], [4.0], [2.0]]).of(swung(duration=2.0), 0)
    np.testing.assert_allclose(keyframes.controls(np.array([0, 0.25, 0.5, 1]))[:, 0], [0, 2, 4, 2])
    assert keyframes.states(np.array([0.5]))[0, 2] == pytest.approx(0.7)
    named = rt.guess.Keyframes([0, 1], [rt.State([0, 0]), rt.State([1, 0])], controls={"u": [1, 3]}).of(pushed(), 0)
    np.testing.assert_allclose(named.controls(np.array([0.5])), [[2.0]])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"times": [0, 1, 1], "q": np.zeros((3, 2))}, "must ascend, but entry 2 is 1 s after 1 s"),
        ({"times": [0.0]}, r"shape \(1,\); give a vector of at least two times"),
        ({"times": [0, np.nan]}, r"times of rt.Guess is nan at index \[1\]; give finite numbers"),
        ({"times": [0, 1], "q": np.zeros((2, 3))}, "q of rt.Guess has 3 columns; it needs 2"),
        ({"times": [0, 1, 2], "q": np.zeros((2, 3))}, r"shape \(2, 3\); .* 3.*Transpose it"),
        ({"times": [0, 1], "v": [[0, np.inf], [0, 0]]}, r"v of rt.Guess is inf at index \[0, 1\]"),
        ({"times": [0, 1], "tau": {"nothing": 0}}, "no joint named 'nothing'"),
        ({"times": [0, 1], "q": {"pole": [0, 1, 2]}}, r"q of rt.Guess of 'pole' has shape \(3,\)"),
        ({"times": [0, 1], "states": np.zeros((2, 4))}, "has states=, but phase 'phase' moves robot 'cartpole'"),
        ({"times": [0, 1], "parameters": {"mass": 1}}, "no parameter named 'mass'"),
        ({"times": [0, 1], "forces": np.zeros((2, 3))}, "forces of rt.Guess must be a mapping"),
        ({"times": [0, 1], "forces": {"foot": np.zeros((2, 3))}}, "no contact named 'foot'"),
        ({"times": [0, 9]}, "span 9 s, but the duration of phase 'phase' lies between 0.5 and 4 s"),
        ({"times": [0, 1], "q": "zero"}, "q of rt.Guess must be an array of numbers"),
    ],
    ids=str,
)
def test_wrong_arrays_of_a_robot_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        rt.Guess(**values).of(swung(), 0)


def test_wrong_arrays_of_a_system_are_refused() -> None:
    with pytest.raises(rt.InputError, match="no state named 'w'.*x, v"):
        rt.Guess([0, 2], states={"w": 0}).of(pushed(), 0)
    with pytest.raises(rt.InputError, match="has q=, but phase 'phase' moves a System; give states=, controls="):
        rt.Guess([0, 2], q=0).of(pushed(), 0)


def test_a_quaternion_of_another_length_is_refused() -> None:
    q = np.zeros((2, 8))
    q[0, 6], q[1, 6] = 1.0, 0.9
    with pytest.raises(rt.InputError, match=r"q of rt.Guess at index 1: the quaternion .* has length 0.9"):
        rt.Guess([0, 2], q=q).of(floating(), 0)


def test_values_of_other_types_are_refused() -> None:
    for wrong in ([], [1, 2], "line", {"q": 0}):
        with pytest.raises(rt.InputError, match="guess= must be None, a guess such as"):
            rt.plan(pushed(), rt.Mesh(3), wrong)


def test_a_guess_prints_one_line_and_keeps_its_arrays() -> None:
    table = np.zeros((2, 2))
    guess = rt.Guess([0, 2], states=table, controls=0)
    table[:] = 7.0
    assert repr(guess) == "Guess(2 times from 0 to 2 s: states, controls)"
    np.testing.assert_array_equal(guess.of(pushed(), 0).states(S), 0)
