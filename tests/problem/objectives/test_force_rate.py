"""Rates of contact forces as a cost and as a bound, on the hopper that bends its leg."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

MESH = rt.Mesh(15, rt.schemes.LobattoIIIA(4))


def squat(objective: object, duration: object = 0.5) -> rt.Solution:
    robot = rt.load("hopper", root="planar")
    stand = {"root_x": 0.0, "root_pitch": 0.0, "hip": 0.0}
    phase = rt.Phase(
        robot,
        duration=duration,
        contacts=[rt.PointContact("foot")],
        start=rt.State(q=stand | {"root_z": 0.6, "leg": 0.6}, v=0),
        end=rt.State(q=stand | {"root_z": 0.45, "leg": 0.45}, v=0),
        objective=objective,
    )
    return rt.plan(phase, mesh=MESH)


def rates(solution: rt.Solution) -> np.ndarray:
    part = solution.phases[0]
    return np.abs(np.array(part.at(part.points).u["rate.force.foot.z"]))


@pytest.fixture(scope="module")
def effort() -> rt.Solution:
    return squat(1e-2 * rt.Effort())


def test_the_cost_is_the_integral_of_the_squared_rate(effort: rt.Solution) -> None:
    solution = squat(1e-2 * rt.Effort() + 1e-3 * rt.objectives.ForceRate())
    times = np.linspace(0, solution.duration, 4001)
    sample = solution.at(times)
    slopes = np.gradient(sample.forces["foot"], times, axis=0)[:, [0, 2]]
    cost = np.trapezoid(1e-3 * (slopes**2).sum(axis=1) + 1e-2 * (sample.tau**2).sum(axis=1), times)
    assert solution.objective == pytest.approx(cost, rel=1e-3)


def test_rates_keep_their_bound_and_take_their_time() -> None:
    bound = 3000.0
    slow = squat(rt.Duration() + 1e-9 * rt.objectives.ForceRate(most=bound), (0.1, 2.0))
    slower = squat(rt.Duration() + 1e-9 * rt.objectives.ForceRate(most=0.3 * bound), (0.1, 2.0))
    assert rates(slow).max() == pytest.approx(bound, rel=1e-3)
    assert rates(slower).max() == pytest.approx(0.3 * bound, rel=1e-3)
    assert slower.duration > slow.duration + 0.02


def test_planned_motions_are_those_of_the_robot_all_the_same(effort: rt.Solution) -> None:
    solution = squat(1e-2 * rt.Effort() + 1e-12 * rt.objectives.ForceRate())
    assert solution.objective == pytest.approx(effort.objective, rel=1e-4)
    assert rt.validate(solution).passed


@pytest.mark.parametrize(
    ("objective", "expected"),
    [
        (rt.objectives.ForceRate({"hand": 1.0}), "hand"),
        (rt.objectives.ForceRate(most=0.0), "most="),
        (rt.objectives.ForceRate(most=np.nan), "most="),
    ],
)
def test_bad_input_is_refused(objective: object, expected: str) -> None:
    with pytest.raises(rt.InputError, match=expected):
        squat(objective)


def test_a_phase_without_contacts_is_refused() -> None:
    with pytest.raises(rt.InputError, match="holds none"):
        rt.Phase(rt.load("pendulum"), duration=1.0, objective=rt.objectives.ForceRate())
