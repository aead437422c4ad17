"""Feet that another phase holds stay above the ground while they swing."""

from __future__ import annotations

from typing import Any

import pytest

import robotraj as rt

HANGING = {"root_x": 0.0, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
"""The foot of the hopper is 0.5 m below its root."""


def landing(height: Any, *constraints: Any, level: float = 0.0) -> rt.Problem:
    """A hopper that flies from a height of its root, and lands on a ground."""
    hopper = rt.load("hopper", root="planar")
    start = rt.State(q={**HANGING, "root_z": height}, v={"root_x": 0, "root_z": 1.0, "root_pitch": 0})
    flight = rt.Phase(hopper, (0.05, 0.3), start, None, rt.Effort(), constraints=constraints, name="flight")
    foot = rt.PointContact("foot", ground=rt.terrain.Flat(level))
    stance = rt.Phase(hopper, (0.2, 1.0), None, rt.State(v=0), rt.Effort(), contacts=[foot], name="stance")
    return rt.Problem([flight, stance], [rt.Touchdown(0, 1)])


def clearances(phase: rt.Phase) -> dict[str, float]:
    return {row.joint: row.lower for row in phase.rows if row.name == "ground clearance"}


def test_a_foot_is_kept_above_the_ground_in_the_phases_that_do_not_hold_it() -> None:
    flight, stance = landing(0.5).phases
    assert clearances(flight) == {"foot": pytest.approx(0.0, abs=1e-3)}
    assert not clearances(stance)


@pytest.mark.parametrize("depth", [0.1, 2e-3])
def test_a_start_below_the_ground_is_refused_with_frame_and_depth(depth: float) -> None:
    with pytest.raises(rt.InputError, match=rf"start has foot 'foot' {depth:g} m below the ground"):
        landing(0.5 - depth)


def test_clearances_of_the_phase_replace_the_default_one_if_they_are_no_lower() -> None:
    own = rt.GroundClearance("foot", 0.05)
    assert landing(0.7, own).phases[0].constraints == (own,)
    low = rt.GroundClearance("foot", -0.2)
    assert len(landing(0.7, low).phases[0].constraints) == 2
    elsewhere = rt.GroundClearance("foot", 0.0, ground=rt.terrain.Flat(-1.0))
    assert len(landing(0.7, elsewhere).phases[0].constraints) == 2


def test_without_a_height_a_foot_may_pass_through_the_ground() -> None:
    through = rt.GroundClearance("foot", None)
    flight = landing(0.4, through).phases[0]
    assert flight.constraints == (through,) and not clearances(flight)


def test_a_foot_that_lands_on_a_box_may_start_below_its_top() -> None:
    hopper = rt.load("hopper", root="planar")
    stand = rt.Phase(hopper, 0.3, contacts=[rt.PointContact("foot")], name="stand")
    flight, land = landing(0.8, level=0.2).phases
    flight = flight.with_(start=None, constraints=())
    problem = rt.Problem([stand, flight, land], [rt.links.Liftoff(0, 1), rt.Touchdown(1, 2)])
    (row,) = problem.phases[1].constraints
    assert row.ground == rt.terrain.Flat(0.0)


def step(*constraints: Any) -> rt.Problem:
    """A step of the five-link biped, whose right foot is held only in the mirror image."""
    robot = rt.load("five_link", root="planar")
    sides = {"left_hip": "right_hip", "left_knee": "right_knee", "left_foot": "right_foot"}
    foot = rt.PointContact("left_foot", friction=0.8)
    anchor = {"left_foot.x": 0.0}
    stance = rt.Phase(robot, 0.7, contacts=[foot], parameters=anchor, constraints=constraints, objective=rt.Effort())
    return rt.Problem([stance], rt.Touchdown(0, 0, repeat=rt.Mirror(sides, displacement={"q.root_x": 0.5})))


def test_the_mirror_image_of_a_standing_foot_stays_above_the_ground() -> None:
    assert set(clearances(step().phases[0])) == {"right_foot"}


def test_the_lowest_flight_begins_with_the_foot_on_the_ground() -> None:
    def lowest(*constraints: Any) -> float:
        flight, stance = landing(rt.between(0.4, 0.6), *constraints).phases
        flight = flight.with_(objective=rt.Mayer(lambda start, end: start.x["q.root_z"]) + 1e-6 * rt.Effort())
        problem = rt.Problem([flight, stance], rt.Touchdown(0, 1))
        return float(rt.plan(problem, rt.Mesh(6), progress=False).at(0.0).q[1])

    assert lowest(rt.GroundClearance("foot", None)) == pytest.approx(0.4, abs=1e-4)
    assert lowest() == pytest.approx(0.5, abs=2e-4)


def test_legs_without_knees_pass_through_the_ground_beside_a_standing_one() -> None:
    walker = rt.load("compass_walker", root="planar")
    stance = rt.Phase(walker, 0.7, contacts=[rt.PointContact("left_foot")], parameters={"left_foot.x": 0.0})
    mirror = rt.Mirror({"left_hip": "right_hip", "left_foot": "right_foot"}, displacement={"q.root_x": 0.4})
    assert not rt.Problem([stance], rt.Touchdown(0, 0, repeat=mirror)).phases[0].constraints


def test_a_problem_that_has_the_rows_is_unchanged_by_a_copy() -> None:
    problem = landing(0.5)
    assert rt.Problem(problem.phases, problem.links).phases == problem.phases
