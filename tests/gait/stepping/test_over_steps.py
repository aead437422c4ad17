"""Calls for stairs and gaps: feet land on treads, away from edges, and the robot ends at rest beyond the last one."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

FOOT = partial(rt.PointContact, friction=0.8)
SLOW: dict[str, Any] = {"contact": FOOT, "swing": 0.5, "shift": 0.4}
PAW: dict[str, Any] = {"contact": partial(rt.PointContact, friction=0.6), "swing": 0.2, "shift": 0.2}


def footholds(problem: rt.Problem, foot: str) -> list[float]:
    """World x of the footholds that phases fix."""
    found = [phase.parameters[f"{foot}.x"] for phase in problem.phases if f"{foot}.x" in phase.parameters]
    return [float(x) for x in found]


def rest(problem: rt.Problem) -> np.ndarray:
    return np.array(problem.phases[-1].end.q, dtype=float)


def test_a_biped_ends_on_top_of_the_stairs(biped: rt.Robot) -> None:
    problem = rt.gait.stairs(biped, start=0.2, run=0.4, rise=0.1, count=2, **SLOW)
    home = rt.gait.stand(biped, None, FOOT)
    data = biped.model.createData()
    pin.framesForwardKinematics(biped.model, data, rest(problem))
    for foot in rt.gait.feet_of(biped, None):
        place = data.oMf[biped.frame(foot)].translation
        assert place[2] == pytest.approx(0.2, abs=1e-6)
        assert place[0] > 0.2 + 0.4
    assert rest(problem)[1] - home[1] == pytest.approx(0.2, abs=1e-3)


def test_the_root_is_bounded_above_the_feet_and_not_above_the_riser_below_it(biped: rt.Robot) -> None:
    problem = rt.gait.stairs(biped, start=0.2, run=0.4, rise=0.1, count=2, **SLOW)
    bounds = []
    for phase in problem.phases:
        (row,) = [each for each in phase.constraints if getattr(each, "name", "") == "root height"]
        bounds.append((row.lower, row.upper))
    (low, high), last = bounds[0], bounds[-1]
    # The first phase leads to the first step, which raises the mean of both feet by half a riser.
    np.testing.assert_allclose(last, (low + 0.2, high + 0.2 - 0.05), atol=1e-9)
    assert bounds == sorted(bounds)


def test_no_foot_stands_near_an_edge(solo: rt.Robot) -> None:
    start, width, margin = 0.25, 0.06, 0.02
    problem = rt.gait.gap(solo, start=start, width=width, step_length=0.08, edge_distance=margin, **PAW)
    feet = rt.gait.feet_of(solo, None)
    places = np.array([x for foot in feet for x in footholds(problem, foot)])
    assert len(places) > 4
    assert ((places <= start - margin + 1e-12) | (places >= start + width + margin - 1e-12)).all()
    data = solo.model.createData()
    pin.framesForwardKinematics(solo.model, data, rest(problem))
    assert min(data.oMf[solo.frame(foot)].translation[0] for foot in feet) > start + width + margin - 1e-6


WRONG: dict[str, tuple[Callable[[rt.Robot], rt.Problem], str]] = {
    "no stairs": (lambda r: rt.gait.stairs(r, start=0.2, run=0.4, rise=0.1, count=0), "at least 1 stair"),
    "short treads": (lambda r: rt.gait.stairs(r, start=0.2, run=0.08, rise=0.1, count=2), "too short for a foot"),
    "no width": (lambda r: rt.gait.gap(r, start=0.2, width=0.0, step_length=0.3), "width.* is 0.0; give a positive"),
    "no step": (lambda r: rt.gait.gap(r, start=0.2, width=0.1, step_length=0.0), "step_length.* give a positive"),
    "near an edge": (
        lambda r: rt.gait.gap(r, start=0.0, width=0.1, step_length=0.3),
        r"covers x = .* from an edge. Increase start= by 0.03\d* m",
    ),
    "own ground": (
        lambda r: rt.gait.gap(r, start=0.2, width=0.1, step_length=0.3, ground=rt.terrain.Flat()),
        "sets its own ground",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_impossible_ground_is_refused(case: str, biped: rt.Robot) -> None:
    make, message = WRONG[case]
    with pytest.raises(rt.InputError, match=message):
        make(biped)


def test_a_sole_over_an_edge_is_named_with_its_ends_and_with_the_start_that_would_do() -> None:
    legs = rt.load("talos_legs", root="floating")
    sole = {"contact": partial(rt.FlatFoot, length=0.2, width=0.12), "feet": ("left_sole_link", "right_sole_link")}
    with pytest.raises(rt.InputError, match=r"covers x = -\S+ to \S+ m, less than \S+ m from") as error:
        rt.gait.gap(legs, start=0.08, width=0.1, step_length=0.3, **sole)
    more = float(str(error.value).partition("Increase start= by ")[2].split()[0])
    assert 0.01 < more < 0.1
    rt.gait.gap(legs, start=0.08 + more + 1e-3, width=0.1, step_length=0.3, **sole)


@pytest.mark.slow
def test_a_biped_climbs_a_stair_and_crosses_a_gap(biped: rt.Robot) -> None:
    mesh = rt.Mesh(6, rt.schemes.LobattoIIIA(4))
    climb = rt.plan(rt.gait.stairs(biped, start=0.2, run=0.4, rise=0.1, count=1, **SLOW), mesh)
    across = rt.plan(rt.gait.gap(biped, start=0.1, width=0.12, step_length=0.3, **SLOW), mesh)
    for solution in (climb, across):
        for t in (0.0, solution.duration):
            np.testing.assert_allclose(solution.at(t).v, 0.0, atol=1e-8)
    assert climb.at(climb.duration).q[1] - climb.at(0.0).q[1] == pytest.approx(0.1, abs=1e-3)
    assert across.at(across.duration).q[0] - across.at(0.0).q[0] >= 0.3 - 1e-6
