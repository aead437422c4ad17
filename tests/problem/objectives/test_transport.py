"""Cost of transport: work by weight and distance."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName

MESH = rt.Mesh(30, rt.schemes.RadauIIA(3))


@pytest.fixture(scope="module")
def block() -> rt.Robot:
    return rt.load("block", limits={"effort": 20.0})


def move(block: rt.Robot, objective: rt.objectives.Objective, end: object = 1.0) -> rt.Phase:
    return rt.Phase(block, duration=1.0, start=rt.State(q=0, v=0), end=rt.State(q=end, v=0), objective=objective)


@pytest.mark.parametrize("frame", [None, "block"])
@pytest.mark.parametrize("work", [rt.objectives.AbsolutePower(), rt.Effort()], ids=["absolute power", "effort"])
def test_over_a_fixed_distance_it_is_the_work_by_weight_and_distance(
    block: rt.Robot, frame: str | None, work: rt.objectives.Objective
) -> None:
    ratio = rt.plan(move(block, rt.objectives.CostOfTransport(frame, work=work)), mesh=MESH)
    total = rt.plan(move(block, work), mesh=MESH)
    assert ratio.objective == pytest.approx(total.objective / (1.0 * 9.81), rel=1e-5)


def test_a_free_distance_is_chosen_for_the_ratio(block: rt.Robot) -> None:
    # Effort is 12 d^2 / T^3, so effort by distance grows with d: the least distance wins.
    phase = move(block, rt.objectives.CostOfTransport(work=rt.Effort()), rt.between(0.25, 2.0))
    solution = rt.plan(phase, mesh=MESH)
    assert solution.at(1.0).q[0] == pytest.approx(0.25, abs=1e-5)
    assert solution.objective == pytest.approx(12.0 * 0.25 / 9.81, rel=1e-5)


def test_the_way_along_a_direction_is_what_counts(block: rt.Robot) -> None:
    straight = rt.plan(move(block, rt.objectives.CostOfTransport(work=rt.Effort())), mesh=MESH)
    slanted = rt.plan(
        move(block, rt.objectives.CostOfTransport(direction=(3.0, 0.0, 4.0), work=rt.Effort())), mesh=MESH
    )
    assert slanted.objective == pytest.approx(straight.objective * 5.0 / 3.0, rel=1e-6)


def test_the_plan_is_simulated_and_its_state_of_work_is_the_work_done(block: rt.Robot) -> None:
    solution = rt.plan(move(block, rt.objectives.CostOfTransport()), mesh=MESH)
    # Torques switch inside intervals, where their polynomials overshoot the limit: only the motion is judged.
    assert rt.validate(solution, limits=np.inf).passed
    work = solution.at(np.array([0.0, 1.0])).x["work"]
    assert work[0] == 0.0
    assert work[1] == pytest.approx(9.81 * solution.objective, rel=1e-9)


def test_what_cannot_be_is_refused(block: rt.Robot) -> None:
    with pytest.raises(UnknownName, match="blok"):
        move(block, rt.objectives.CostOfTransport("blok"))
    with pytest.raises(InputError, match="direction"):
        move(block, rt.objectives.CostOfTransport(direction=(0.0, 0.0, 0.0)))
    with pytest.raises(InputError, match="integral"):
        move(block, rt.objectives.CostOfTransport(work=rt.Duration()))
    with pytest.raises(InputError, match="two"):
        move(block, rt.objectives.CostOfTransport() + rt.objectives.CostOfTransport())
