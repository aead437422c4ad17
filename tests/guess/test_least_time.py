"""The fastest motion on a straight line: closed forms, limits, and lines without bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.guess.ends import ends_of
from robotraj.guess.least_time import Trapezoid, fastest_line

FAST = rt.Duration()


def rest(*q: float) -> rt.State:
    return rt.State(q=list(q), v=0)


def move(robot: rt.Robot, start: rt.State, end: rt.State, **more: object) -> rt.Phase:
    given = {"duration": (0.1, 20), "start": start, "end": end, "objective": FAST}
    return rt.Phase(robot, **(given | more))


def law_of(phase: rt.Phase) -> Trapezoid | None:
    return fastest_line(phase, *ends_of(phase))


def block() -> rt.Robot:
    """One kilogram, one newton."""
    return rt.load("block")


@pytest.mark.parametrize("distance", [-0.1, 1, 10])
def test_a_block_takes_the_time_of_full_force_forwards_then_backwards(distance: float) -> None:
    law = law_of(move(block(), rest(0), rest(distance)))
    assert law is not None
    assert law.duration == pytest.approx(2 * np.sqrt(abs(distance)), rel=1e-12)


def test_under_a_speed_limit_a_block_cruises() -> None:
    slow = block().limits.with_(velocity=2.0)
    law = law_of(move(block(), rest(0), rest(10), limits=slow))
    assert law is not None
    assert law.duration == pytest.approx(10 / 2 + 2 / 1, rel=1e-12)
    np.testing.assert_allclose(law.times, [0, 2, 5, 7])


def test_acceleration_limits_and_bounds_given_by_name_count() -> None:
    gentle = block().limits.with_(acceleration=0.25)
    weak = {"tau.slider": rt.between(-0.25, 3)}
    for more in ({"limits": gentle}, {"controls": weak}, {"limits": None, "controls": weak}):
        law = law_of(move(block(), rest(0), rest(1), **more))
        assert law is not None
        assert law.duration == pytest.approx(4, rel=1e-12)


def test_speeds_at_the_ends_shorten_the_time() -> None:
    """From 1 to 2 m/s over 4 m under 1 m/s^2: p^2 = 4 + (1 + 4) / 2."""
    ends = rt.State(q=0, v=1), rt.State(q=4, v=2)
    law = law_of(move(block(), *ends))
    assert law is not None
    assert law.duration == pytest.approx(2 * np.sqrt(6.5) - 3, rel=1e-12)


def test_end_speeds_beyond_the_limits_are_reduced() -> None:
    law = Trapezoid.of(np.inf, 1.0, 5.0, 0.0)
    assert law.first == pytest.approx(np.sqrt(2))
    assert law.duration == pytest.approx(np.sqrt(2))


@pytest.mark.parametrize(
    "law", [Trapezoid.of(np.inf, 3.0), Trapezoid.of(0.5, 3.0), Trapezoid.of(2.0, 3.0, 0.5, 1.0)], ids=str
)
def test_a_law_rises_from_0_to_1_and_its_rates_are_its_derivatives(law: Trapezoid) -> None:
    np.testing.assert_allclose(law.motion(np.array([0.0, 1.0]))[0], [0, 1], atol=1e-12)
    f, h = np.linspace(0.013, 0.987, 60), 1e-6
    ahead, behind, here = law.motion(f + h), law.motion(f - h), law.motion(f)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * h), here[1], rtol=1e-7)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * h), here[2], atol=1e-6)
    assert np.max(here[1]) <= law.peak * law.duration * (1 + 1e-12)
    assert np.max(np.abs(here[2])) <= law.slope * law.duration**2 * (1 + 1e-12)


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_an_arm_keeps_its_limits_and_meets_one_of_them(name: str) -> None:
    """Without the Coriolis and centrifugal forces, which the least time neglects."""
    robot = rt.load(name)
    rng = np.random.default_rng(0)
    q, way = robot.neutral, 0.4 * rng.uniform(-1, 1, robot.nv)
    law = law_of(move(robot, rest(*q), rest(*(q + way))))
    assert law is not None
    data, still = robot.model.createData(), np.zeros(robot.nv)
    share = []
    for s in np.linspace(0, 1, 9):
        gravity = pin.rnea(robot.model, data, q + s * way, still, still).copy()
        for sign in (1, -1):
            torque = gravity + robot.friction * np.sign(way)
            torque = torque + sign * (pin.crba(robot.model, data, q + s * way) @ way) * law.slope
            share.append(np.max(np.abs(torque) / robot.limits.effort))
    speed = np.max(np.abs(way) * law.peak / robot.limits.velocity)
    assert max(share) == pytest.approx(1, abs=1e-9) or speed == pytest.approx(1, abs=1e-9)
    assert max(*share, speed) <= 1 + 1e-9


def test_without_bounds_on_accelerations_there_is_no_fastest_line() -> None:
    cartpole, pendulum = rt.load("cartpole"), rt.load("pendulum")
    weak = pendulum.limits.with_(effort=0.1)
    unlimited = block().limits.with_(effort=np.inf)
    assert law_of(move(cartpole, rest(0, 0), rest(1, np.pi))) is None  # the pole has no motor
    assert law_of(move(pendulum, rest(0), rest(np.pi), limits=weak)) is None  # it has to swing
    assert law_of(move(block(), rest(0), rest(1), limits=unlimited)) is None
    assert law_of(move(block(), rest(1), rest(1))) is None
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    assert law_of(rt.Phase(system, (0.1, 9), rt.State([0, 0]), rt.State([1, 0]), FAST)) is None


def test_a_free_duration_starts_at_one_and_a_half_times_the_least_or_above() -> None:
    far = move(block(), rest(0), rest(10))
    guess = rt.guess.StraightLine().of(far, 0)
    assert guess.duration == pytest.approx(1.5 * 2 * np.sqrt(10))
    assert rt.guess.StraightLine().of(replace(far, duration=(0.1, 8)), 0).duration == 8
    assert rt.guess.StraightLine(7.0).of(far, 0).duration == 7
    near = move(block(), rest(0), rest(0.01))
    assert rt.guess.StraightLine().of(near, 0).duration == pytest.approx(np.sqrt(0.1 * 20))


@pytest.mark.parametrize("duration", [None, 7.0])
def test_the_line_is_run_with_the_speeds_and_accelerations_of_its_fastest_motion(duration: float | None) -> None:
    guess = rt.guess.StraightLine(duration).of(move(block(), rest(0), rest(10)), 0)
    f, h = np.array([0.1, 0.3, 0.7, 0.9]), 1e-6
    q, v = guess.states(f).T
    np.testing.assert_allclose(q, 10 * np.array([0.02, 0.18, 0.82, 0.98]))
    rates = (guess.states(f + h) - guess.states(f - h)) / (2 * h * guess.duration)
    np.testing.assert_allclose(rates[:, 0], v, rtol=1e-7)
    np.testing.assert_allclose(rates[:, 1], guess.algebraic(f)[:, 0], rtol=1e-7)
    np.testing.assert_allclose(np.abs(guess.algebraic(f)), 4 * 10 / guess.duration**2)


def test_a_fixed_duration_keeps_one_speed() -> None:
    guess = rt.guess.StraightLine().of(move(block(), rest(0), rest(10), duration=8.0), 0)
    np.testing.assert_allclose(guess.states(np.array([0.2, 0.5]))[:, 1], 10 / 8)
    np.testing.assert_array_equal(guess.algebraic(np.array([0.2, 0.5])), 0)
