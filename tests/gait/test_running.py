"""Running with the five-link biped: stance, flight of free duration, and a landing on the other foot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

STEP, TIME, FRICTION = 1.0, 0.4, 0.8
MASS = 40.0


def running() -> rt.Problem:
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=FRICTION)
    written = rt.gait.run(robot, step_length=STEP, duration=TIME, contact=foot, margin=0.0)
    phases = [replace(phase, duration=(0.05, 0.35)) for phase in written.phases]
    pace = rt.links.Linkage([0, 1], lambda a, b: b.end.t - a.start.t, TIME, TIME, name="time of a step", unit="s")
    return rt.Problem(phases, [*written.links, pace])


@pytest.fixture(scope="module")
def run() -> rt.Solution:
    return rt.plan(running(), rt.Mesh(12, rt.HermiteSimpson(control=rt.schemes.LinearControl())))


def feet(robot: rt.Robot, q: np.ndarray) -> np.ndarray:
    """Places (2, 2) of left and right foot, x and z [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return np.array([data.oMf[robot.frame(f"{side}_foot")].translation[[0, 2]] for side in ("left", "right")])


def flown(run: rt.Solution) -> np.ndarray:
    flight = run.phases[1]
    return flight.t0 + flight.duration * np.linspace(0.01, 0.99, 99)


def test_nothing_touches_the_ground_in_flight(run: rt.Solution) -> None:
    robot = run.phases[0].robot
    assert robot is not None
    sample = run.at(flown(run))
    assert not np.any(sample.forces["left_foot"])
    lowest = np.array([feet(robot, q)[:, 1].min() for q in sample.q])
    assert lowest.min() > -2e-4 and lowest.max() > 0.02
    assert run.phases[1].duration > 0.1


def test_the_centre_of_mass_falls_freely(run: rt.Solution) -> None:
    robot = run.phases[0].robot
    assert robot is not None
    data = robot.model.createData()
    times = flown(run)
    sample = run.at(times)
    heights = [pin.centerOfMass(robot.model, data, q)[[0, 2]] for q in sample.q]
    parabola = np.polyfit(times - times[0], np.array(heights), 2)
    assert parabola[0] == pytest.approx([0.0, -0.5 * 9.81], abs=2e-3)


def test_forces_and_impulses_carry_the_weight(run: rt.Solution) -> None:
    """Normal force and landing impulse together are weight times the duration of the step; friction sums to zero."""
    stance = run.phases[0]
    times = np.linspace(0, stance.duration * (1 - 1e-12), 2001)
    force = run.at(times).forces["left_foot"]
    landing = run.impulses[1]
    given = np.trapezoid(force, times, axis=0)[[0, 2]] + [landing[f"impulse.left_foot.{axis}"] for axis in "xz"]
    assert given == pytest.approx([0.0, MASS * 9.81 * TIME], abs=0.05)
    assert (np.abs(force[:, 0]) <= FRICTION * force[:, 2] + 1e-6).all()
    assert abs(landing["impulse.left_foot.x"]) <= FRICTION * landing["impulse.left_foot.z"] + 1e-6


def test_it_lands_mirrored_one_step_on(run: rt.Solution) -> None:
    robot = run.phases[0].robot
    assert robot is not None
    first, last = run.at(0.0), run.at(TIME)
    swap = [0, 1, 2, 5, 6, 3, 4]
    assert last.q[swap] - first.q == pytest.approx([STEP, *np.zeros(6)], abs=1e-8)
    before, after = feet(robot, first.q), feet(robot, last.q)
    assert after[1] == pytest.approx(before[0] + [STEP, 0.0], abs=1e-7)


@pytest.mark.slow
def test_a_free_flight_duration_costs_no_more(run: rt.Solution) -> None:
    problem = running()
    short = [replace(problem.phases[0], duration=0.28), replace(problem.phases[1], duration=0.12)]
    fixed = rt.plan(replace(problem, phases=short), rt.Mesh(12, rt.HermiteSimpson(control=rt.schemes.LinearControl())))
    assert run.objective < fixed.objective


@pytest.mark.slow
def test_the_witness_runs_as_planned() -> None:
    mesh = rt.Mesh(10, rt.HermiteSimpson(control=rt.schemes.LinearControl()))
    solution = rt.plan(running(), mesh, tolerance=1e-5)
    assert solution.objective == pytest.approx(5682.9, rel=1e-4)
    report = rt.validate(solution)
    assert report.passed
    report.check(drift=1e-4, contact=1e-5)


def test_samples_across_phases_have_what_all_phases_have(run: rt.Solution) -> None:
    """Forces are contacts' unknowns of the stance alone; the sample of both phases gives them as zero in flight."""
    times = np.array([0.01, run.phases[1].t0 + 0.01])
    both = run.at(times)
    assert "force.left_foot.z" in run.at(times[0]).z and "force.left_foot.z" not in both.z
    assert both.forces["left_foot"][0, 2] > 0 and not both.forces["left_foot"][1].any()
    assert both.z["a.left_hip"] == pytest.approx(both.a[:, 3])
