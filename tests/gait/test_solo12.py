"""Solo12 trots and jumps: planned from the built-in guess, proved by simulation, followed by MuJoCo."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from tests.robots.walkers import (
    GRAVITY,
    apex,
    assert_cones_hold,
    assert_it_is_proved,
    assert_it_repeats_mirrored,
    assert_the_ground_carries_the_weight,
    objective,
)

pytestmark = pytest.mark.slow

FRICTION = 0.5


@pytest.fixture(scope="module")
def trot(solo: rt.Robot) -> rt.Solution:
    foot = partial(rt.PointContact, friction=FRICTION)
    stride = rt.gait.trot(
        solo, step_length=0.06, duration=0.2, clearance=0.04, contact=foot, objective=objective(solo, foot)
    )
    return rt.plan(stride, mesh=rt.Mesh(5, rt.schemes.LobattoIIIA(4)))


@pytest.fixture(scope="module")
def jump(solo: rt.Robot) -> rt.Solution:
    foot = partial(rt.PointContact, friction=FRICTION, cone=rt.contacts.Linearised(4), normal_force=(0.5, 40.0))
    posture = objective(solo, foot, calm=1e-4)
    leap = rt.gait.jump(solo, length=0.1, height=0.08, push=0.25, land=0.25, contact=foot, objective=posture)
    return rt.plan(leap, mesh=[rt.Mesh(n, rt.HermiteSimpson()) for n in (18, 12, 14)])


def test_a_trot_is_planned_and_proved(trot: rt.Solution) -> None:
    assert_it_is_proved(trot)
    assert_cones_hold(trot, FRICTION)


def test_a_trot_repeats_mirrored_and_lifts_its_feet(trot: rt.Solution) -> None:
    assert_it_repeats_mirrored(trot, {"FL": "FR", "HL": "HR"})
    assert min(apex(trot, foot) for foot in ("FR_FOOT", "HL_FOOT")) > 0.039


def test_the_ground_carries_the_weight(trot: rt.Solution) -> None:
    assert_the_ground_carries_the_weight(trot)


def test_mujoco_trots_four_half_strides(trot: rt.Solution) -> None:
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    opinion = rt.witness.second_opinion(trot, periods=4)
    assert opinion.completed and opinion.upright


def test_a_jump_is_planned_and_proved(jump: rt.Solution) -> None:
    assert_it_is_proved(jump)
    assert_cones_hold(jump, FRICTION)


def test_in_flight_the_centre_of_mass_falls_freely(jump: rt.Solution) -> None:
    flight = jump.phases[1]
    robot = flight.phase.robot
    assert robot is not None
    times = np.linspace(flight.t0, flight.t0 + flight.duration, 9)[1:-1]
    data = robot.model.createData()
    mass = np.array([np.array(pin.centerOfMass(robot.model, data, q)) for q in jump.at(times).q])
    parabola = np.polyfit(times, mass[:, 2], 2)
    assert 2.0 * parabola[0] == pytest.approx(-GRAVITY, rel=1e-3)
    assert np.max(np.abs(np.polyval(parabola, times) - mass[:, 2])) < 1e-5
