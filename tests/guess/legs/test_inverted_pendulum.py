"""The inverted pendulum: feet keep their footholds, velocities are rates, forces balance the motion."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from robotraj.guess.default import default_guess
from robotraj.guess.legs.centre_of_mass import Pendulum, heights
from robotraj.guess.legs.inverted_pendulum import InvertedPendulum
from robotraj.guess.legs.schedule import schedule_of

GRAVITY = 9.81


@pytest.fixture(scope="module")
def trot() -> rt.Problem:
    robot = rt.load("solo12", root="floating")
    return gait.trot(robot, step_length=0.1, duration=0.25, clearance=0.03)


def _speed(pendulum: Pendulum, knots: np.ndarray, t: float, side: int) -> float:
    """One-sided difference of second order [m/s]."""
    h = 1e-5 * side
    x = [pendulum.at(knots, t + k * h) for k in range(3)]
    return (-3.0 * x[0] + 4.0 * x[1] - x[2]) / (2.0 * h)


def test_a_pendulum_obeys_its_equation() -> None:
    pendulum = Pendulum([0.0, 0.4, 0.7], [0.1, np.nan], 3.2)
    knots = pendulum.joining(0.02, 0.3)
    assert (pendulum.at(knots, 0.0), pendulum.at(knots, 0.7)) == pytest.approx((0.02, 0.3))
    assert _speed(pendulum, knots, 0.4, -1) == pytest.approx(_speed(pendulum, knots, 0.4, 1), abs=1e-8)
    h = 1e-4
    for t, acceleration in ((0.2, lambda x: 3.2**2 * (x - 0.1)), (0.55, lambda x: 0.0)):
        x = [pendulum.at(knots, t + k * h) for k in (-1, 0, 1)]
        assert (x[2] - 2 * x[1] + x[0]) / h**2 == pytest.approx(acceleration(x[1]), abs=1e-5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_pendulum_repeats(sign: float) -> None:
    pendulum = Pendulum([0.0, 0.1, 0.5], [0.05, 0.2], 3.0)
    knots = pendulum.repeating(sign, 0.3)
    assert knots[-1] == pytest.approx(sign * knots[0] + 0.3)
    assert _speed(pendulum, knots, 0.5, -1) == pytest.approx(sign * _speed(pendulum, knots, 0.0, 1), abs=1e-8)


def test_a_pendulum_above_many_steps_stays_between_its_feet() -> None:
    """x lies between its feet where it starts and ends there: the maximum principle of x'' = w^2 (x - p)."""
    count = 60
    feet = np.cumsum(np.random.default_rng(0).uniform(0.0, 0.1, count))
    pendulum = Pendulum(np.linspace(0.0, 30.0, count + 1), feet, 6.0)
    knots = pendulum.joining(feet[0], feet[-1])
    path = [pendulum.at(knots, t) for t in np.linspace(0.0, 30.0, 1001)]
    assert feet[0] - 1e-12 <= min(path) <= max(path) <= feet[-1] + 1e-12
    assert np.min(np.diff(path)) > -1e-12


def test_a_flight_is_a_parabola() -> None:
    z = heights([0.0, 0.2, 0.5], [0.3, 0.3, 0.3], [False, True], GRAVITY, repeats=True)
    t = np.linspace(0.2, 0.5, 9)
    np.testing.assert_allclose(z(t, 2), -GRAVITY, atol=1e-9)
    assert z(0.0, 1) == pytest.approx(z(0.5, 1))


def test_stances_run_through_periods(trot: rt.Problem) -> None:
    schedule = schedule_of(trot)
    stands = schedule.stands("FR_FOOT")
    assert [(s.start, s.end) for s in stands][:2] == [(-0.25, 0.0), (0.25, 0.5)]
    assert {c.name for c in schedule.contacts} == {"FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"}


def test_fixed_footholds_are_reached() -> None:
    robot = rt.load("solo12", root="floating")
    every = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")
    q = gait.stand(robot, feet=every)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    # Steps of different length: a walk with equal steps does not reach the end.
    steps = {"FR_FOOT": 0.02, "HL_FOOT": 0.07}
    spots = {foot: float(data.oMf[robot.frame(foot)].translation[0]) + step for foot, step in steps.items()}

    def phase(feet: tuple[str, ...], **more: object) -> rt.Phase:
        return rt.Phase(robot, 0.2, contacts=[rt.PointContact(foot) for foot in feet], **more)

    phases = [
        phase(every, start=rt.State(q=q, v=0.0)),
        phase(("FL_FOOT", "HR_FOOT")),
        phase(every, parameters={f"{foot}.x": x for foot, x in spots.items()}),
    ]
    problem = rt.Problem(phases, [rt.links.Liftoff(0, 1), rt.Continuity(1, 2)])
    guess = default_guess(problem).prepared(problem)
    for i, share in ((1, 1.0), (2, 0.0), (2, 1.0)):
        x = guess.of(phases[i], i).states(np.array([share]))[0]
        pin.framesForwardKinematics(robot.model, data, x[: robot.nq])
        for foot, place in spots.items():
            assert data.oMf[robot.frame(foot)].translation[0] == pytest.approx(place, abs=1e-6)
    first = guess.of(phases[0], 0).states(np.array([0.0]))[0]
    np.testing.assert_allclose(first[: robot.nq], q, atol=1e-6)


def test_feet_stand_and_swing(trot: rt.Problem) -> None:
    phase = trot.phases[0]
    guess = default_guess(trot).prepared(trot).of(phase, 0)
    robot = phase.robot
    assert robot is not None
    s = np.linspace(0.0, 1.0, 11)
    x = guess.states(s)
    heights_of = {foot: [] for foot in ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")}
    data = robot.model.createData()
    for q in x[:, : robot.nq]:
        assert np.linalg.norm(q[3:7]) == pytest.approx(1.0, abs=1e-12)
        pin.framesForwardKinematics(robot.model, data, q)
        for foot, values in heights_of.items():
            values.append(data.oMf[robot.frame(foot)].translation.copy())
    for foot in ("FL_FOOT", "HR_FOOT"):
        places = np.array(heights_of[foot])
        np.testing.assert_allclose(places[:, 2], 0.0, atol=1e-6)
        np.testing.assert_allclose(places, places[:1].repeat(11, axis=0), atol=1e-6)
        assert guess.parameters[f"{foot}.x"] == pytest.approx(places[0, 0], abs=1e-6)
    for foot in ("FR_FOOT", "HL_FOOT"):
        places = np.array(heights_of[foot])
        assert places[5, 2] > 0.03
        np.testing.assert_allclose(places[[0, -1], 2], 0.0, atol=1e-6)
        assert places[-1, 0] - places[0, 0] == pytest.approx(0.2, abs=1e-6)


def test_velocities_are_those_of_the_motion(trot: rt.Problem) -> None:
    phase = trot.phases[0]
    robot = phase.robot
    assert robot is not None
    guess = InvertedPendulum().prepared(trot).of(phase, 0)
    h = 1e-5
    ahead, here, behind = (guess.states(np.array([0.37 + k * h]))[0] for k in (1, 0, -1))
    along = pin.difference(robot.model, behind[: robot.nq], ahead[: robot.nq]) / (2 * h * guess.duration)
    np.testing.assert_allclose(here[robot.nq :], along, atol=1e-5)


def test_forces_carry_the_robot_inside_their_cones(trot: rt.Problem) -> None:
    phase = trot.phases[0]
    guess = InvertedPendulum().prepared(trot).of(phase, 0)
    names = [z.name for z in phase.dae.algebraic]
    z = guess.algebraic(np.linspace(0.0, 1.0, 21))
    up = sum(z[:, names.index(f"force.{foot}.z")] for foot in ("FL_FOOT", "HR_FOOT"))
    robot = phase.robot
    assert robot is not None
    weight = GRAVITY * pin.computeTotalMass(robot.model)
    assert np.mean(up) == pytest.approx(weight, rel=0.1)
    for foot in ("FL_FOOT", "HR_FOOT"):
        fx, fy, fz = (z[:, names.index(f"force.{foot}.{axis}")] for axis in "xyz")
        assert np.all(np.hypot(fx, fy) < 0.7 * fz)


def test_feet_stand_on_given_footholds() -> None:
    robot = rt.load("five_link", root="planar")
    problem = gait.walk(robot, step_length=0.4, duration=0.6)
    phase = problem.phases[0]
    moved = rt.Phase(
        robot, 0.6, contacts=phase.contacts, parameters={"left_foot.x": 1.5}, objective=rt.Effort(), name="there"
    )
    guess = default_guess(rt.Problem([moved], problem.links)).prepared(rt.Problem([moved], problem.links)).of(moved, 0)
    q = guess.states(np.array([0.5]))[0, : robot.nq]
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    assert data.oMf[robot.frame("left_foot")].translation[0] == pytest.approx(1.5, abs=1e-6)


def test_the_default_guess_of_legs_is_the_pendulum(trot: rt.Problem) -> None:
    assert isinstance(default_guess(trot), InvertedPendulum)
    arm = rt.load("two_link_arm")
    assert isinstance(default_guess(rt.Problem([rt.Phase(arm, 1.0)])), rt.guess.StraightLine)
    with pytest.raises(rt.InputError, match="root='floating'"):
        InvertedPendulum().prepared(rt.Problem([rt.Phase(arm, 1.0)]))
    solo = rt.load("solo12", root="floating")
    with pytest.raises(rt.InputError, match="contacts with the ground"):
        InvertedPendulum().prepared(rt.Problem([gait.Flight(solo, 0.2)]))


def test_a_mass_below_its_contact_gets_a_finite_guess_and_a_plan() -> None:
    """A contact in the hip of the hopper, above its centre of mass: no inverted pendulum has that height."""
    hopper = rt.load("hopper", root="planar")
    hang = rt.Phase(
        hopper,
        (0.3, 1.0),
        rt.State(q={"root_x": 0.0}, v=0),
        rt.State(v=0),
        rt.Effort() + rt.Duration(),
        contacts=[rt.PointContact("sleeve")],
    )
    assert rt.plan(hang, progress=False).proof.holds
