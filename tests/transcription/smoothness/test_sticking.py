"""The price of accelerations where dry friction lets joints move in bursts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.refinement.objective_quadrature import smoothing_cost
from robotraj.transcription.smoothness.sticking import acceleration_weights

UR5 = rt.load("ur5")
START, END = np.zeros(6), np.array([1.0, -0.5, 0.5, 0.0, 0.0, 0.2])


def moved(friction: float, duration: Any = 2.0, objective: Any = None, **more: Any) -> rt.Phase:
    robot = replace(UR5, friction=np.full(6, friction))
    ends = rt.State(q=START, v=0), rt.State(q=END, v=0)
    return rt.Phase(robot, duration, *ends, objective or rt.Effort(), self_collision=False, **more)


def price(phase: rt.Phase) -> float:
    return float(acceleration_weights(phase).max())


def test_the_price_vanishes_with_the_square_of_the_friction() -> None:
    """An arm whose friction is too small to matter is planned as one without."""
    assert price(moved(0.0)) == 0.0
    assert price(moved(1e-6)) == pytest.approx(1e-12 * price(moved(1.0)))


def test_the_price_is_that_of_the_motion_in_any_time() -> None:
    """The accelerations of a motion that is k times as slow fall by k^2, and cost as much a second."""
    assert price(moved(1.0, 20.0)) == pytest.approx(1e4 * price(moved(1.0, 2.0)))


def test_the_price_follows_the_weight_of_the_effort() -> None:
    assert price(moved(1.0, objective=0.5 * rt.Effort())) == pytest.approx(0.5 * price(moved(1.0)))


@pytest.mark.parametrize(
    "phase",
    [
        moved(1.0, (0.1, 5.0), rt.Duration()),
        moved(1.0).with_(end=rt.State(v=0)),
        moved(1.0).with_(end=rt.State(q=START, v=0)),
        moved(1.0, objective=rt.objectives.Jerk()),
    ],
    ids=["least time", "a free end", "no way", "no torques"],
)
def test_no_price_where_friction_or_the_way_costs_nothing(phase: rt.Phase) -> None:
    assert price(phase) == 0.0


def test_the_objective_is_that_of_the_problem() -> None:
    """Of all motions the chosen one has the least sum of effort and price, so it loses no more than that price."""
    plain, priced = (rt.plan(moved(0.5), rt.Mesh(30), smoothing=each) for each in (0.0, 5e-3))
    (part,) = plain.phases
    most = smoothing_cost(part.phase, part.trajectory, part.mesh.schemes, 5e-3)
    assert 0.0 < most < 1e-2 * plain.objective
    assert priced.objective <= plain.objective + most
    squares = [float((plan.at(np.linspace(0.0, 2.0, 999)).a ** 2).mean()) for plan in (plain, priced)]
    assert squares[1] < squares[0]


@pytest.mark.slow
def test_a_light_arm_does_not_move_in_bursts() -> None:
    """The wrist of z1 may move whenever it likes: without the price its torques jump 20 times, and are not proved."""
    robot = rt.load("z1")
    rng = np.random.default_rng(21)
    low, high = np.maximum(robot.limits.position_lower, -3), np.minimum(robot.limits.position_upper, 3)
    first, last = (low + (0.1 + 0.8 * rng.random(robot.nq)) * (high - low) for _ in range(2))
    ends = rt.State(q=first, v=0), rt.State(q=last, v=0)
    phase = rt.Phase(robot, 2.3, *ends, rt.Effort(), self_collision=False)

    def reversals(plan: rt.Solution) -> int:
        v = plan.at(np.linspace(0.0, 2.3, 4001)).v
        return int((np.diff(np.sign(np.where(np.abs(v) > 0.05, v, 0.0)), axis=0) != 0).sum())

    calm, free = rt.plan(phase), rt.plan(phase, smoothing=0.0)
    assert calm.proof is not None and calm.proof.holds
    assert calm.objective <= 1.02 * free.objective
    assert reversals(calm) < reversals(free)
