"""The legs of Talos walk on flat feet with double support: all limits of the URDF, simulation, MuJoCo."""

from __future__ import annotations

from functools import partial

import casadi as ca
import numpy as np
import pytest

import robotraj as rt

pytestmark = pytest.mark.slow

FEET = ("left_sole_link", "right_sole_link")
LENGTH, DURATION, FRICTION = 0.2, 0.8, 0.6
HALVES = np.array([0.1, 0.06])


@pytest.fixture(scope="module")
def walk() -> rt.Solution:
    robot = rt.load("talos_legs", root="floating")
    sole = partial(rt.FlatFoot, length=2 * HALVES[0], width=2 * HALVES[1], friction=FRICTION)
    posture = rt.gait.gait_objective(robot, rt.gait.stand(robot, FEET, sole))
    step = rt.gait.walk(
        robot,
        feet=FEET,
        contact=sole,
        step_length=LENGTH,
        duration=DURATION,
        double_support=0.2,
        clearance=0.04,
        objective=posture + 0.3 * rt.Lagrange(lambda point: ca.sumsqr(point.a[6:])),
        # The inertias of its legs are not each other's mirror images: both steps are planned.
        repeat=rt.Periodic(),
    )
    return rt.plan(step, mesh=[rt.Mesh(n, rt.schemes.LobattoIIIA(4)) for n in (5, 7, 5, 7)])


def test_a_step_is_planned_and_proved(walk: rt.Solution) -> None:
    report = rt.validate(walk)
    report.check(contact=1e-4)
    assert max(max(h.slip.value, h.sink.value, h.turn.value) for h in report.holdings) < 1e-5
    assert not any(v.name.endswith("limit") for v in report.violations)


def test_the_limits_of_the_urdf_hold_at_all_times(walk: rt.Solution) -> None:
    robot = walk.phases[0].phase.robot
    assert robot is not None
    limits, sample = robot.limits, walk.at(np.linspace(0.0, DURATION, 400))
    assert np.all(np.isfinite(limits.effort[6:]))
    assert np.all(np.abs(sample.tau) <= limits.effort[6:] + 1e-3)
    assert np.all(np.abs(sample.v[:, 6:]) <= limits.velocity[6:] + 1e-3)
    assert np.all(sample.q[:, 7:] <= limits.position_upper[6:] + 1e-3)
    assert np.all(sample.q[:, 7:] >= limits.position_lower[6:] - 1e-3)


def test_pressure_stays_inside_the_soles_and_forces_inside_the_cones(walk: rt.Solution) -> None:
    # The soles stay level and turn little: moments about world axes at their frames are those about their own.
    for force in walk.at(np.linspace(0.0, DURATION, 400)).forces.values():
        held = force[:, 2] > 1.0
        up, along = force[held, 2], np.linalg.norm(force[held, :2], axis=1)
        assert np.all(along <= FRICTION * up + 1.0)
        pressure = np.column_stack([-force[held, 4], force[held, 3]]) / up[:, None]
        assert np.all(np.linalg.norm(pressure, axis=1) <= np.linalg.norm(HALVES) + 1e-3)


def test_mujoco_walks_four_steps(walk: rt.Solution) -> None:
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    opinion = rt.witness.second_opinion(walk, periods=2)
    assert opinion.completed and opinion.upright
    assert opinion.simulation.q[-1, 0] - opinion.simulation.q[0, 0] == pytest.approx(4 * LENGTH, abs=0.1)
