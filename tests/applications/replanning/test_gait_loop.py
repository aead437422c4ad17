"""A gait that is planned again: its steps enter and leave the horizon, and its plans follow the robot."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.applications.replanning.gait_ticks import cycle_of, ticks_of, touching
from robotraj.guess.legs.stance import BalancedStance

PERIOD = 0.175
"""Four ticks a step of five_link."""


@pytest.fixture(scope="module")
def walk() -> rt.Problem:
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=0.8)
    return rt.gait.walk(robot, step_length=0.4, duration=0.7, contact=foot, clearance=0.02)


@pytest.fixture(scope="module")
def gait(walk: rt.Problem) -> rt.Solution:
    return rt.plan(walk)


@pytest.fixture(scope="module")
def replanner(walk: rt.Problem, gait: rt.Solution) -> rt.Replanner:
    return rt.Replanner(walk, guess=gait, period=PERIOD, ahead=1, solver=rt.InteriorPoint(tolerance=1e-6))


def state(sample, away: float = 0.0) -> rt.State:
    q = np.array(sample.q)
    q[0] += away
    return rt.State(q=q, v=sample.v)


def feet_of(part) -> set[str]:
    return {contact.frame for contact in part.phase.bound_contacts}


def test_steps_enter_and_leave_the_horizon(gait: rt.Solution) -> None:
    ticks = ticks_of(cycle_of(gait), PERIOD, ahead=2)
    assert len(ticks) == 8
    np.testing.assert_allclose([tick.t for tick in ticks], PERIOD * np.arange(8))
    for k, tick in enumerate(ticks):
        phases = tick.problem.phases
        np.testing.assert_allclose([p.duration_bounds[0] for p in phases], [0.7 - (k % 4) * PERIOD, 0.7, 0.7])
        standing = [p.contacts[0].frame for p in phases]
        assert standing[0] == standing[2] != standing[1]
        assert (standing[0] == ticks[0].feet[0]) == (k < 4)


def test_a_plan_starts_at_the_measured_state_and_goes_on_to_the_next_step(
    replanner: rt.Replanner, gait: rt.Solution
) -> None:
    measured = gait.at(PERIOD)
    replan = replanner.step(PERIOD, state(measured))
    assert replan.fresh and replan.start == PERIOD and replan.end == pytest.approx(1.4)
    np.testing.assert_allclose(replan.at(PERIOD).q, measured.q, atol=1e-6)
    np.testing.assert_allclose(replan.at(PERIOD).v, measured.v, atol=1e-5)
    assert feet_of(replan.motion) != feet_of(replan.later[0])
    np.testing.assert_allclose(replan.at(0.699).q, replan.at(0.701).q, atol=2e-2)
    data = (model := replan.motion.robot.model).createData()
    (frame,) = feet_of(replan.motion)
    heights = []
    for t in np.linspace(PERIOD, 0.69, 7):
        pin.framesForwardKinematics(model, data, replan.at(t).q)
        heights.append(data.oMf[model.getFrameId(frame)].translation)
    np.testing.assert_allclose(np.array(heights)[:, 2], 0.0, atol=1e-4)
    assert np.ptp(np.array(heights)[:, 0]) < 1e-3


def test_a_robot_elsewhere_a_cycle_later_moves_alike(replanner: rt.Replanner, gait: rt.Solution) -> None:
    """The ground is level, and the gait repeats: displacements of place and of time by a cycle change nothing else."""
    here = replanner.step(2 * PERIOD, state(gait.at(2 * PERIOD)))
    there = replanner.step(2 * PERIOD + 1.4, state(gait.at(2 * PERIOD), 5.0))
    times = here.start + np.linspace(0.0, 0.34, 5)
    np.testing.assert_allclose(there.at(times + 1.4).q - here.at(times).q, [[5.0, *[0.0] * 6]] * 5, atol=1e-3)
    (foot,) = [contact.name for contact in here.motion.phase.bound_contacts]
    assert there.motion.parameters[f"{foot}.x"] - here.motion.parameters[f"{foot}.x"] == pytest.approx(5.0, abs=1e-3)


def test_feet_that_land_early_or_late_move_the_clock(walk: rt.Problem, gait: rt.Solution) -> None:
    early, late = (rt.Replanner(walk, guess=gait, period=PERIOD, ahead=1) for _ in range(2))
    first = early.step(0.0, state(gait.at(0.0)))
    (standing,), (coming,) = feet_of(first.motion), feet_of(first.later[0])
    landed = early.step(3 * PERIOD, state(early._gait.ticks[4]), contacts={standing, coming})
    assert feet_of(landed.motion) == {coming} and landed.motion.duration == pytest.approx(0.7)
    assert feet_of(early.step(4 * PERIOD, state(early._gait.ticks[5])).motion) == {coming}
    waiting = late.step(4 * PERIOD, state(gait.at(3 * PERIOD)), contacts={standing})
    assert feet_of(waiting.motion) == {standing} and waiting.motion.duration == pytest.approx(PERIOD)


def test_a_measured_state_is_moved_onto_its_contacts() -> None:
    robot = rt.load("solo12", root="floating")
    feet = ("FL_FOOT", "HR_FOOT")
    stance = BalancedStance(robot, tuple(rt.PointContact(foot).bound_to(robot) for foot in feet))
    rng = np.random.default_rng(0)
    q = pin.integrate(robot.model, rt.gait.stand(robot), 0.01 * rng.standard_normal(robot.nv))
    v = rng.standard_normal(robot.nv)
    held, still = touching(stance, q, v)
    rows, _ = stance.places(held, stance.locate(held))
    np.testing.assert_allclose(rows, 0.0, atol=1e-9)
    jacobian = stance.jacobian(held)
    np.testing.assert_allclose(jacobian @ still, 0.0, atol=1e-9)
    mass = pin.crba(robot.model, stance.data, held)
    mass = np.triu(mass) + np.triu(mass, 1).T
    # The change is J' times an impulse: any velocity that keeps the feet at rest is further away.
    impulse = np.linalg.lstsq(jacobian.T, mass @ (v - still), rcond=None)[0]
    np.testing.assert_allclose(jacobian.T @ impulse, mass @ (v - still), atol=1e-9)
    again = touching(stance, held, still)
    np.testing.assert_allclose(again[0], held, atol=1e-9)
    np.testing.assert_allclose(again[1], still, atol=1e-9)


def test_bad_input(replanner: rt.Replanner, walk: rt.Problem, gait: rt.Solution) -> None:
    here = state(gait.at(0.0))
    with pytest.raises(rt.InputError, match="start and contacts alone"):
        replanner.step(0.0, here, end=here)
    with pytest.raises(rt.InputError, match="every q and v"):
        replanner.step(0.0, rt.State(q=gait.at(0.0).q))
    with pytest.raises(rt.InputError, match="period"):
        rt.Replanner(walk, guess=gait, period=-0.1)
    with pytest.raises(rt.InputError, match="ahead"):
        rt.Replanner(walk, guess=gait, ahead=0)
    with pytest.raises(rt.InputError, match="driven"):
        rt.applications.driven([replanner.step(0.1 * k, here) for k in range(2)], until=0.3)
    block = rt.Phase(rt.load("block"), 3.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    with pytest.raises(rt.InputError, match="contacts="):
        rt.Replanner(block, mesh=rt.Mesh(5)).step(0.0, rt.State(q=0, v=0), contacts=[])


@pytest.mark.slow
def test_a_trot_of_solo12_keeps_its_speed_under_pushes_in_mujoco() -> None:
    mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    from robotraj.witness.mujoco.feet import SoftGround, feet_of, furnish
    from robotraj.witness.mujoco.model import mujoco_robot
    from robotraj.witness.mujoco.reference_motion import ReferenceMotion

    robot = rt.load("solo12", root="floating")
    foot = rt.PointContact("FL_FOOT", friction=0.7)
    trot = rt.gait.trot(robot, step_length=0.06, duration=0.2, contact=foot, clearance=0.03)
    gait = rt.plan(trot)
    replanner = rt.Replanner(trot, guess=gait)
    course = ReferenceMotion(gait, 3)
    plant = mujoco_robot(robot, None, partial(furnish, course, feet_of(course), SoftGround()))
    plant.model.opt.timestep, plant.model.opt.impratio = 1e-3, 10.0
    plant.model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    data, coordinates = mujoco.MjData(plant.model), plant.coordinates
    first = gait.at(0.0)
    data.qpos[:], data.qvel[:] = coordinates.qpos(first.q), coordinates.qvel(first.q, first.v)
    weight, actuation = 9.81 * pin.computeTotalMass(robot.model), np.asarray(robot.actuation, dtype=float)
    kept, iterations = 0, []
    for k in range(75):
        q = coordinates.q(data.qpos)
        replan = replanner.step(0.02 * k, rt.State(q=q, v=coordinates.v(q, data.qvel)))
        kept += not replan.fresh
        iterations.append(replan.iterations)
        for i in range(20):
            planned, q = replan.at(0.02 * k + 1e-3 * (i + 0.5)), coordinates.q(data.qpos)
            v = coordinates.v(q, data.qvel)
            tau = planned.tau + 3.0 * (planned.q[7:] - q[7:]) + 0.08 * (planned.v[6:] - v[6:])
            # Half the weight for 0.1 s to the side: an impulse of half a metre a second.
            data.xfrc_applied[1, 1] = 0.5 * weight if 25 <= k < 30 else 0.0
            data.qfrc_applied[:] = coordinates.force(q, actuation @ tau)
            mujoco.mj_step(plant.model, data)
        assert data.qpos[2] > 0.7 * first.q[2]
    assert kept == 0 and np.median(iterations) <= 4
    assert data.qpos[0] > 0.6 * 75 * 0.02 * 0.3
    assert abs(coordinates.v(q, data.qvel)[1]) < 0.2
