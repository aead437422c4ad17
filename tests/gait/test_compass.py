"""The compass gait as a plan: its passive cycle, and its cost on level ground.

The cycle's numbers are those that tests/robots/test_compass_walker.py finds by simulation and its own impact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.base import Solver
from tests.programs import nlp_of

LEGS = {"left_hip": "right_hip", "left_foot": "right_foot"}
LOBATTO = rt.Mesh(10, rt.schemes.LobattoIIIA(4))


def step(descent: float, length: Any, duration: Any = (0.65, 1.2), **more: Any) -> rt.Problem:
    """One step on a slope, after which the swing foot is on the ground; the motor of the hip is the textbook's."""
    walker = rt.load("compass_walker", root="planar")
    rise = -np.tan(descent)

    def height(point: Any) -> Any:
        foot = point.frame("right_foot").position
        return foot[2] - rise * foot[0]

    motor = rt.PathConstraint(lambda point: point.tau[0] + point.tau[1], 0, 0, name="one motor")
    phase = rt.Phase(
        walker,
        duration,
        rt.State(q={"root_pitch": 0}),
        contacts=[rt.PointContact("left_foot", ground=rt.terrain.Slope(rise))],
        parameters={"left_foot.x": 0},
        constraints=[motor, rt.AtEnd(rt.PathConstraint(height, 0, 0, name="foot on the ground"))],
        objective=rt.Effort(),
        **more,
    )
    mirror = rt.Mirror(LEGS, displacement={"q.root_x": length, "q.root_z": None})
    return rt.Problem([phase], [rt.Touchdown(0, 0, repeat=mirror)])


@pytest.fixture(scope="module")
def level() -> rt.Solution:
    return rt.plan(step(0.0, 0.4), LOBATTO)


@pytest.mark.parametrize(
    ("descent", "half", "rates", "period", "length"),
    [
        (np.deg2rad(3), 0.27102868, (1.09238359, 0.37737395), 0.73434639, 0.53544542),
        (0.0525, 0.27127462, (1.09286681, 0.37613459), 0.73446062, 0.53591932),
    ],
)
def test_the_optimum_on_a_slope_is_the_passive_cycle(
    descent: float, half: float, rates: tuple[float, float], period: float, length: float
) -> None:
    solution = rt.plan(step(descent, rt.between(0.3, 0.8)), LOBATTO, tolerance=1e-7)
    assert solution.objective < 1e-10
    assert np.abs(solution.at(np.linspace(0, solution.duration, 101)).tau).max() < 1e-5
    first, last = solution.at(0.0), solution.at(solution.duration)
    assert first.q[2:] == pytest.approx([0.0, descent - half, descent + half], abs=2e-7)
    assert first.v[2:] == pytest.approx([0.0, *rates], abs=1e-6)
    assert solution.duration == pytest.approx(period, abs=1e-7)
    gained = last.q[:2] - first.q[:2]
    assert np.linalg.norm(gained) == pytest.approx(length, abs=1e-6)
    assert gained[1] / gained[0] == pytest.approx(-np.tan(descent), abs=1e-8)


def test_the_other_passive_cycle_is_shorter() -> None:
    """Two gaits of one step go down a gentle slope; the short one is unstable (Goswami, Thuilot and Espiau 1996)."""
    solution = rt.plan(step(0.0525, rt.between(0.3, 0.8), (0.5, 0.62)), LOBATTO, tolerance=1e-6)
    assert solution.objective < 1e-10
    assert 0.5 < solution.duration < 0.62


def test_a_step_on_the_level_pays_for_its_impact(level: rt.Solution) -> None:
    """The work of the motors in a period is the energy that the impact dissipates."""
    times = np.linspace(0, level.duration, 4001)
    sample = level.at(times)
    work = np.trapezoid((sample.tau * sample.v[:, 3:]).sum(axis=1), times)
    first, last = level.at(0.0), level.at(level.duration)
    taken = energy(level, last.q, last.v) - energy(level, first.q, first.v)
    assert work == pytest.approx(taken, rel=1e-5)
    assert work > 1.0


def test_the_motor_is_between_the_legs(level: rt.Solution) -> None:
    sample = level.at(np.linspace(0, level.duration, 101))
    assert np.abs(sample.tau.sum(axis=1)).max() < 1e-6
    assert np.abs(sample.q[:, 2]).max() < 1e-8


@pytest.mark.slow
def test_longer_steps_cost_more(level: rt.Solution) -> None:
    assert rt.plan(step(0.0, 0.5), LOBATTO).objective > 1.5 * level.objective


@pytest.mark.parametrize("solver", [rt.Ipopt(), rt.InteriorPoint(fallback=None)], ids=["ipopt", "interior point"])
def test_redundant_rows_leave_a_unique_solution(level: rt.Solution, solver: Solver) -> None:
    """No motor turns the hip, and the impact keeps its rate: one row is redundant."""
    nlp = nlp_of(step(0.0, 0.4), LOBATTO)
    rng = np.random.default_rng(3)
    iterations = set()
    for size in (0.0, 1e-12, 1e-9):
        guess = nlp.guess + size * nlp.scale * rng.standard_normal(len(nlp.guess))
        outcome = solver.solve(replace(nlp, guess=guess))
        assert outcome.status is rt.solvers.Status.SOLVED
        iterations.add(outcome.iterations)
        assert nlp.objective(outcome.w) == pytest.approx(level.objective, rel=1e-8)
    assert len(iterations) == 1


def test_the_witness_walks_as_planned(level: rt.Solution) -> None:
    report = rt.validate(level)
    assert report.passed
    report.check(drift=1e-4, contact=1e-5)


def energy(solution: rt.Solution, q: np.ndarray, v: np.ndarray) -> float:
    import pinocchio as pin

    robot = solution.phases[0].robot
    assert robot is not None
    data = robot.model.createData()
    return float(pin.computeKineticEnergy(robot.model, data, q, v) + pin.computePotentialEnergy(robot.model, data, q))
