"""Terms that contacts add to the equations: one function for all footholds, with the same values and derivatives."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.contact_terms import extract_addends, insert_graphs, separate_contact_terms
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import symbols_of


@pytest.fixture(scope="module")
def robot() -> rt.Robot:
    return rt.load("solo12", root="floating")


def rows(phase: rt.Phase, point: RobotPoint, c: ca.SX) -> ca.SX:
    """All rows that depend on contacts."""
    body = phase.body
    return ca.vertcat(body.residual(point), body.correction(point, c), body.invariant(point))


def posed(robot: rt.Robot, feet: list[str], **more: float) -> tuple[rt.Phase, RobotPoint, ca.SX]:
    contacts = [rt.PointContact(foot, **more) for foot in feet]
    phase = rt.Phase(robot, 0.3, contacts=contacts)
    point = symbols_of(phase.body, phase.parameter_names)
    return phase, point, ca.SX.sym("c", len(phase.body.invariants))


def test_phases_share_what_a_foot_adds(robot: rt.Robot) -> None:
    one, other = (
        separate_contact_terms(phase.body, point, c)
        for phase, point, c in (posed(robot, ["FL_FOOT", "HR_FOOT"]), posed(robot, ["FR_FOOT", "HR_FOOT", "HL_FOOT"]))
    )
    assert len(one) == 10
    assert len(other) == 15
    known = {id(part.addend) for part in one}
    assert len([part for part in other if id(part.addend) in known]) == 5


def test_a_single_foot_is_not_corrected_along_its_jacobian(robot: rt.Robot) -> None:
    phase, point, c = posed(robot, ["HR_FOOT"])
    assert len(separate_contact_terms(phase.body, point, c)) == 4
    assert not ca.depends_on(
        phase.body.correction(point, c), ca.vertcat(*(s.reaction for s in point.contact_terms.values()))
    )


@pytest.mark.parametrize("feet", [["HR_FOOT"], ["FL_FOOT", "HR_FOOT", "HL_FOOT"]])
def test_the_rows_are_the_same_apart_and_written_out(robot: rt.Robot, feet: list[str]) -> None:
    phase, point, c = posed(robot, feet)
    plain = rows(phase, point, c)
    parts = separate_contact_terms(phase.body, point, c)
    separated = rows(phase, point, c)
    every = ca.vertcat(*(ca.symvar(plain)))
    both = ca.Function("both", [every], [plain, insert_graphs(separated, parts)])
    first, second = both(np.random.default_rng(4).uniform(0.2, 1.2, every.numel()))
    np.testing.assert_allclose(np.array(first), np.array(second), atol=1e-9)
    assert not any(ca.depends_on(insert_graphs(separated, parts), part.symbols) for part in parts)


def test_what_reads_expressions_is_written_out(robot: rt.Robot) -> None:
    phase, point, c = posed(robot, ["FL_FOOT", "HR_FOOT"])
    parts = separate_contact_terms(phase.body, point, c)
    y = rows(phase, point, c)
    known = ca.vertcat(point.q, point.v, point.a, *point.p.values(), c)
    rest, added = extract_addends(y, known, parts)
    # The forces are not among its symbols: only the reactions depend on them.
    assert len(added) == 8
    reactions = ca.vertcat(*(part.symbols for part in parts if part.symbols.numel() == robot.nv))
    assert not ca.depends_on(rest, reactions)
    forces = ca.vertcat(*point.z.values())[robot.nv :]
    assert ca.depends_on(rest, forces)
