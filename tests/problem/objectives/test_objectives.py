"""Objectives add up, scale, and equal their formulas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
SQUARE = rt.Lagrange(lambda point: point.u["u"] ** 2)


def move(objective: object, duration: object = 1.0, **more: object) -> rt.Phase:
    return rt.Phase(BLOCK, duration, rt.State([0, 0]), rt.State([1, 0]), objective, **more)


def test_effort_is_the_integral_of_squared_torques_without_a_half() -> None:
    assert rt.plan(move(rt.Effort()), rt.Mesh(4)).objective == pytest.approx(12.0, rel=1e-9)
    assert rt.plan(move(SQUARE), rt.Mesh(4)).objective == pytest.approx(12.0, rel=1e-9)


def test_weighted_effort_and_time_have_the_analytical_optimum() -> None:
    """12 w / T^3 + c T is least at T = (36 w / c)^(1/4)."""
    w, c = 0.5, 3.0
    solution = rt.plan(move(w * SQUARE + rt.Duration() * c, (0.1, 9)), rt.Mesh(4))
    best = (36 * w / c) ** 0.25
    assert solution.duration == pytest.approx(best, rel=1e-6)
    assert solution.objective == pytest.approx(12 * w / best**3 + c * best, rel=1e-9)


def test_sums_multiples_and_python_sum_agree() -> None:
    written = SQUARE + 2 * rt.Duration()
    summed = sum([SQUARE, rt.Duration(), rt.Duration()])
    nested = 2 * (0.5 * SQUARE + rt.Duration())
    found = [rt.plan(move(objective, (0.5, 3)), rt.Mesh(4)).objective for objective in (written, summed, nested)]
    assert found == pytest.approx([found[0]] * 3, rel=1e-9)


@pytest.mark.parametrize("wrong", [lambda: SQUARE + 1.0, lambda: 2 - SQUARE, lambda: SQUARE - 3, lambda: 1 + SQUARE])
def test_a_number_is_no_objective_but_its_weight(wrong: object) -> None:
    with pytest.raises(rt.InputError, match="multiplies a term as its weight"):
        wrong()  # type: ignore[operator]


def test_effort_weighs_joints_by_order_or_by_name() -> None:
    start, end = rt.State(q=[0, 0.5], v=0), rt.State(q=[0.5, -0.2], v=0)

    def cost(weights: object) -> float:
        phase = rt.Phase(rt.load("two_link_arm"), 4.0, start, end, rt.Effort(weights))
        return rt.plan(phase, rt.Mesh(20)).objective

    assert cost([2, 3]) == pytest.approx(cost({"shoulder": 2, "elbow": 3}), rel=1e-9)
    assert cost(2.0) == pytest.approx(2 * cost(None), rel=1e-7)
    assert cost({"elbow": 1}) < cost(None)


def test_mayer_reads_both_ends_and_the_time() -> None:
    """Least (x_end - 3)^2 + t_end^2 of a mass at unit speed: t = 3/2."""
    drift = rt.System(["x"], [], lambda point: [1.0])
    cost = rt.Mayer(lambda start, end: (end.x["x"] - start.x["x"] - 3) ** 2 + end.t**2)
    solution = rt.plan(rt.Phase(drift, (0.1, 9), rt.State([5]), objective=cost), rt.Mesh(3))
    assert solution.duration == pytest.approx(1.5, abs=1e-7)
    assert solution.objective == pytest.approx(4.5, abs=1e-8)


def test_mayer_of_a_robot_reads_frames_and_the_centre_of_mass() -> None:
    robot = rt.load("pendulum")
    cost = rt.Mayer(lambda start, end: -100 * end.frame("tip").position[2] - 0 * end.com[2]) + rt.Effort()
    limits = robot.limits.with_(effort=50.0)
    solution = rt.plan(
        rt.Phase(robot, 2.0, rt.State(q=[0], v=0), rt.State(q=[rt.between(0.5, 6)], v=0), cost, limits=limits)
    )
    assert solution.at(2.0).q[0] == pytest.approx(np.pi, abs=0.2)


def test_lagrange_may_read_the_time() -> None:
    """The integral of (u - t)^2 is 0 for u = t, which moves x by 1/6 in a second."""
    cost = rt.Lagrange(lambda point: (point.u["u"] - point.t) ** 2)
    phase = rt.Phase(BLOCK, 1.0, rt.State([0, 0]), objective=cost)
    solution = rt.plan(phase, rt.Mesh(3))
    assert solution.objective == pytest.approx(0, abs=1e-12)
    assert solution.at(1.0).x["x"] == pytest.approx(1 / 6, abs=1e-7)


def test_the_objective_is_the_integral_along_the_trajectory() -> None:
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2 + point.x["x"] ** 2)
    solution = rt.plan(move(cost), rt.Mesh(10, rt.schemes.GaussLegendre(points=4)))
    exact = quad(lambda t: solution.at(t).u["u"] ** 2 + solution.at(t).x["x"] ** 2, 0, 1, limit=200)[0]
    assert solution.objective == pytest.approx(exact, rel=1e-7)


@pytest.mark.parametrize(
    "mistake",
    [
        lambda: 0.1 * rt.Duration,
        lambda: rt.Duration * np.float64(0.1),
        lambda: rt.Effort() + rt.Duration,
        lambda: rt.Duration - rt.Effort(),
        lambda: -rt.Duration,
        lambda: sum([rt.Duration, rt.Effort()]),
    ],
)
def test_arithmetic_with_a_class_of_objectives_shows_how_it_is_called(mistake: Any) -> None:
    with pytest.raises(rt.InputError, match=r"Duration is a class.* 0\.1 \* rt\.Duration\(\)"):
        mistake()
