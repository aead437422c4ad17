"""A mirror that swaps legs needs the pairs of feet."""

from __future__ import annotations

import pytest

import robotraj as rt
from tests.programs import nlp_of


@pytest.fixture(scope="module")
def walker() -> rt.Robot:
    return rt.load("compass_walker", root="planar")


def standing(walker: rt.Robot, *feet: str) -> rt.Phase:
    return rt.Phase(walker, (0.5, 1.0), contacts=[rt.PointContact(foot) for foot in feet], name="step")


def legs(**more: str) -> rt.Mirror:
    return rt.Mirror({"left_hip": "right_hip", **more}, displacement={"q.root_x": 0.4})


def test_a_foot_without_a_partner_is_refused(walker: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="'left_hip', which carries contact 'left_foot', with 'right_hip'"):
        rt.Problem([standing(walker, "left_foot")], [rt.Touchdown(0, 0, repeat=legs())])
    with pytest.raises(rt.InputError, match="name the contact's partner"):
        rt.Problem([standing(walker, "left_foot", "right_foot")], [legs()])


def test_it_is_refused_where_a_flight_closes_the_gait(walker: rt.Robot) -> None:
    phases = [standing(walker, "left_foot"), standing(walker)]
    with pytest.raises(rt.InputError, match="contact 'left_foot'"):
        rt.Problem(phases, [rt.links.Liftoff(0, 1), rt.Touchdown(1, 0, repeat=legs())])


def test_feet_that_are_named_are_imposed_where_they_newly_stand(walker: rt.Robot) -> None:
    problem = rt.Problem([standing(walker, "left_foot")], [rt.Touchdown(0, 0, repeat=legs(left_foot="right_foot"))])
    rows = nlp_of(problem, rt.Mesh(2)).rows
    held = [rows.entries[k].name for k, fraction in zip(rows.meaning, rows.fraction, strict=True) if fraction == 0.0]
    assert [held.count(f"contact {level}") for level in ("position", "velocity")] == [2, 2]
