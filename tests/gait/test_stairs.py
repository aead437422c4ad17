"""Up one stair, from rest to rest: footholds on treads, feet above edges, and the energy of a climb."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

pytestmark = pytest.mark.slow

RISE, WEIGHT = 0.1, 40 * 9.81
LEFT, RIGHT = "left_foot", "right_foot"
STAIRS = rt.terrain.Steps.stairs(start=0.2, run=0.4, rise=RISE, count=1)


@pytest.fixture(scope="module")
def climb() -> rt.Solution:
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact(LEFT, friction=0.8, ground=STAIRS)
    stands = [((LEFT, RIGHT), 0.3), ((LEFT,), (0.4, 0.7)), ((RIGHT,), (0.4, 0.7)), ((LEFT, RIGHT), 0.3)]
    supports = [rt.gait.Support(feet, duration, f"part {i}") for i, (feet, duration) in enumerate(stands)]
    terms = rt.gait.GaitTerms(foot, clearance=0.0, objective=rt.Effort(), ground=STAIRS)
    start = rt.State(q=rt.gait.stand(robot), v=0)
    written = rt.gait.sequence(robot, supports, terms, None, start, rt.State(v=0))
    on_top = rt.between(0.25, 0.6)
    places = [{}, {}, {"right_foot.x": on_top}, {"right_foot.x": on_top, "left_foot.x": on_top}]
    phases = [replace(phase, parameters=where) for phase, where in zip(written.phases, places, strict=True)]
    return rt.plan(rt.Problem(phases, written.links), rt.Mesh(8, rt.schemes.LobattoIIIA(4)))


def feet(climb: rt.Solution, times: np.ndarray) -> np.ndarray:
    """Places (m, 2, 3) of left and right foot [m]."""
    robot = climb.phases[0].robot
    assert robot is not None
    data, found = robot.model.createData(), []
    for q in climb.at(times).q:
        pin.framesForwardKinematics(robot.model, data, q)
        found.append([np.array(data.oMf[robot.frame(name)].translation) for name in (LEFT, RIGHT)])
    return np.array(found)


def test_feet_stand_on_treads_and_stay_there(climb: rt.Solution) -> None:
    for k, name in enumerate((LEFT, RIGHT)):
        for phase in climb.phases:
            if f"{name}.x" not in phase.parameters:
                continue
            place = phase.parameters[f"{name}.x"]
            height = next(h for low, high, h in STAIRS.treads if low <= place <= high)
            times = phase.t0 + phase.duration * np.linspace(0.001, 0.999, 100)
            away = feet(climb, times)[:, k, [0, 2]] - [place, height]
            assert np.abs(away).max() < 1e-4


def test_feet_swing_over_the_edge(climb: rt.Solution) -> None:
    places = feet(climb, np.linspace(0, climb.duration, 1001)).reshape(-1, 3)
    assert (places[:, 2] - STAIRS.height(places[:, 0], places[:, 1])).min() > -1e-3


def test_it_starts_and_ends_at_rest_on_both_feet(climb: rt.Solution) -> None:
    first, last = climb.at(0.0), climb.at(climb.duration)
    assert first.v == pytest.approx(0, abs=1e-9) and last.v == pytest.approx(0, abs=1e-9)
    ends = feet(climb, np.array([0.0, climb.duration]))[:, :, 2]
    assert ends == pytest.approx(np.array([[0.0, 0.0], [RISE, RISE]]), abs=1e-7)
    assert last.forces[LEFT][2] + last.forces[RIGHT][2] > 0.5 * WEIGHT


def test_the_work_of_the_motors_is_potential_energy_and_impact(climb: rt.Solution) -> None:
    robot = climb.phases[0].robot
    assert robot is not None
    data = robot.model.createData()

    def energy(sample: rt.solution.Sample) -> float:
        kinetic = pin.computeKineticEnergy(robot.model, data, sample.q, sample.v)
        return float(kinetic + pin.computePotentialEnergy(robot.model, data, sample.q))

    work = 0.0
    for phase in climb.phases:
        times = phase.t0 + phase.duration * np.linspace(1e-9, 1 - 1e-9, 2001)
        sample = climb.at(times)
        work += float(np.trapezoid((sample.tau * sample.v[:, 3:]).sum(axis=1), times))
    step = climb.phases[2].t0
    lost = energy(climb.phases[1].at(step)) - energy(climb.phases[2].at(step))
    gained = energy(climb.at(climb.duration)) - energy(climb.at(0.0))
    assert lost > 1.0
    assert work == pytest.approx(gained + lost, rel=2e-3)
    (impulse,) = [each for each in climb.impulses if each]
    assert impulse["impulse.right_foot.z"] > 0
