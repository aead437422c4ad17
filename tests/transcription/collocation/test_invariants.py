"""Invariants of contacts are imposed where the fixed ends of a phase do not determine them already."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.transcription.collocation.invariants import determined_invariants, start_invariants
from tests.programs import nlp_of

STAND = {"root_x": 0.0, "root_pitch": 0.0, "hip": 0.0, "root_z": 0.6, "leg": 0.6}


@pytest.fixture(scope="module")
def hopper() -> rt.Robot:
    return rt.load("hopper", root="planar")


def phase(hopper: rt.Robot, start: rt.State, end: rt.State | None = None, **more: object) -> rt.Phase:
    return rt.Phase(hopper, 0.5, start, end, contacts=[rt.PointContact("foot")], **more)


def of_positions(each: rt.Phase) -> np.ndarray:
    return np.array([row.quantity != "contact velocity" for row in each.dae.invariants])


def test_a_fixed_start_determines_the_contact_where_its_place_is_given(hopper: rt.Robot) -> None:
    given = phase(hopper, rt.State(q=STAND, v=0), parameters={"foot.x": 0.0})
    at_start, at_end = determined_invariants(given)
    assert at_start.all() and not at_end.any()
    assert start_invariants([given], 0, []) == []


def test_one_end_determines_a_place_that_is_free_and_the_other_end_only_then(hopper: rt.Robot) -> None:
    both = phase(hopper, rt.State(q=STAND, v=0), rt.State(q=STAND, v=0))
    at_start, at_end = determined_invariants(both)
    along = np.array(["foot.x" in row.name for row in both.dae.invariants]) & of_positions(both)
    # The fixed start and the free place give a row; with it, the fixed end adds nothing.
    assert along.sum() == 1 and not at_start[along].any() and at_start[~along].all()
    assert start_invariants([both], 0, []) == np.flatnonzero(along).tolist()


def test_without_contacts_there_is_nothing_to_determine(hopper: rt.Robot) -> None:
    flight = rt.Phase(hopper, 0.5, rt.State(q=STAND, v=0))
    assert [each.size for each in determined_invariants(flight)] == [0, 0]
    assert start_invariants([flight], 0, []) == []


def test_rest_determines_velocities_of_contacts_in_any_pose(hopper: rt.Robot) -> None:
    at_rest, _ = determined_invariants(phase(hopper, rt.State(v=0)))
    moving, _ = determined_invariants(phase(hopper, rt.State(v=0.1)))
    given = phase(hopper, rt.State(v=0))
    assert at_rest.tolist() == (~of_positions(given)).tolist()
    assert not moving.any()


def test_a_squat_keeps_its_foot_in_place_at_every_knot(hopper: rt.Robot) -> None:
    low = STAND | {"root_z": 0.45, "leg": 0.45}
    squat = phase(hopper, rt.State(q=STAND, v=0), rt.State(q=low, v=0), objective=rt.Effort())
    nlp = nlp_of(rt.Problem([squat]), rt.Mesh(4))
    held = np.isin([nlp.rows.entries[k].name for k in nlp.rows.meaning], ["contact position", "contact velocity"])
    assert held.any() and not nlp.rows.lower[held].any() and not nlp.rows.upper[held].any()
    solution = rt.plan(squat, rt.Mesh(4))
    data, foot = hopper.model.createData(), hopper.frame("foot")
    places = []
    for q in solution.at(solution.knots).q:
        pin.framesForwardKinematics(hopper.model, data, q)
        places.append(data.oMf[foot].translation.copy())
    assert np.ptp(np.array(places), axis=0).max() < 1e-6


@pytest.mark.parametrize(
    ("before", "after", "imposed"),
    [
        ("sole", "toe", set()),
        ("heel", "sole", {"pitch"}),
        ("point", "sole", {"pitch"}),
        ("heel", "toe", {"height", "along"}),
        ("heel", "heel", set()),
    ],
)
def test_a_contact_imposes_what_the_one_of_its_name_did_not_hold(before: str, after: str, imposed: set[str]) -> None:
    """Kinds of one contact in two phases of a planar robot: speeds that the first one leaves free are imposed."""
    robot = rt.load("five_link", root="planar")
    kinds = {
        "sole": rt.FlatFoot("left_foot", 0.2),
        "heel": rt.contacts.LineContact("left_foot", offset=(-0.1, 0.0, 0.0)),
        "toe": rt.contacts.LineContact("left_foot", offset=(0.1, 0.0, 0.0)),
        "point": rt.PointContact("left_foot"),
    }
    phases = [rt.Phase(robot, 0.2, objective=rt.Effort(), contacts=[kinds[name]]) for name in (before, after)]
    problem = rt.Problem(phases, [rt.Continuity(0, 1)])
    rows = [problem.phases[1].dae.invariants[i] for i in start_invariants(problem.phases, 1, problem.bound_links)]
    names = {"x": "along", "z": "height", "ry": "pitch"}
    speeds = {names[row.name.rpartition(".")[2]] for row in rows if row.quantity == "contact velocity"}
    assert speeds == imposed
