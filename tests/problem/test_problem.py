"""Phases and problems are frozen and bind by name; their text lists every row that they impose."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from tests.programs import nlp_of

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], units={"x": "m", "v": "m/s", "u": "N"})


def cartpole(**more: Any) -> rt.Phase:
    given = {
        "duration": (1, 3),
        "start": rt.State(q=[0, 0], v=0),
        "end": rt.State(q=[1, np.pi], v=0),
        "objective": rt.Effort(),
    }
    return rt.Phase(rt.load("cartpole"), **(given | more))


def table_of(phase: rt.Phase) -> list[list[str]]:
    """The printed table as cells, two spaces apart, without its two head lines."""
    return [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in str(phase).splitlines()[2:]]


def test_a_phase_prints_every_row_with_when_bounds_and_unit() -> None:
    phase = cartpole(constraints=[rt.GroundClearance("tip", -0.7), rt.AtEnd(rt.FramePosition("tip", [1, None, None]))])
    lines = table_of(phase)
    assert ["duration", "1 .. 3", "s"] in lines
    assert ["position", "pole", "start", "= 0", "rad"] in lines
    assert ["velocity", "slider", "end", "= 0", "m/s"] in lines
    assert ["position limit", "slider", "throughout", "-2 .. 2", "m"] in lines
    assert ["effort limit", "slider", "throughout", "-20 .. 20", "N"] in lines
    assert ["ground clearance", "tip", "throughout", ">= -0.7", "m"] in lines
    assert ["frame position x", "tip", "end", "= 1", "m"] in lines
    assert ["torque balance", "pole", "throughout", "= 0", "N m"] in lines
    assert "minimise Effort" in str(phase)


def test_what_is_printed_is_what_is_imposed() -> None:
    """As many kinds of rows and bounds as lines."""
    nlp = nlp_of(rt.Problem([cartpole()]), rt.Mesh(3))
    printed = {(line[0], line[1]) for line in table_of(cartpole()) if "throughout" in line}
    rows = {(entry.name, entry.label.removeprefix("q.")) for entry in nlp.rows.entries}
    assert {("torque balance", "pole"), ("torque balance", "slider")} <= printed & rows
    bounds = {(e.name, e.label) for i, e in enumerate(nlp.variables.entries) if i in set(nlp.variables.upper_meaning)}
    limits = {line for line in printed if line[0].endswith("limit")}
    assert limits == {bound for bound in bounds if bound[0].endswith("limit")}


def test_a_problem_prints_its_phases_and_links() -> None:
    first, second = cartpole(end=None, name="one"), cartpole(start=None, name="two")
    text = str(rt.Problem([first, second], [rt.Continuity(0, 1)]))
    assert all(
        part in text for part in ("phase 'one'", "phase 'two'", "Continuity(0, 1)", "continuity, time", "q.pole")
    )


def test_phases_and_problems_are_frozen() -> None:
    phase = cartpole()
    with pytest.raises(dataclasses.FrozenInstanceError):
        phase.duration = 3.0  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError):
        rt.Problem([phase]).phases = ()  # type: ignore[misc]


def test_limits_hold_unless_they_are_none() -> None:
    names = {row.name for constraint in cartpole().bound_constraints for row in constraint.rows}
    assert names == {"position limit", "effort limit"}
    assert cartpole(limits=None).bound_constraints == ()
    slower = rt.load("cartpole").limits.with_(velocity={"pole": 4.0})
    rows = [row for c in cartpole(limits=slower).bound_constraints for row in c.rows if row.name == "velocity limit"]
    assert [(row.joint, row.lower, row.upper) for row in rows] == [("pole", -4.0, 4.0)]


def test_without_limits_the_start_may_lie_anywhere() -> None:
    assert cartpole(limits=None, start=rt.State(q=[-30, 0], v=0)).start_bounds.lower[0] == -30


@pytest.mark.parametrize(
    ("state", "lower", "upper"),
    [
        (rt.State(), [-np.inf] * 4, [np.inf] * 4),
        (rt.State(q=0, v=[1, None]), [0, 0, 1, -np.inf], [0, 0, 1, np.inf]),
        (rt.State(q={"pole": rt.between(-1, 2)}, v=0), [-np.inf, -1, 0, 0], [np.inf, 2, 0, 0]),
        (
            rt.State(q=np.array([[1.0], [2.0]], dtype=np.float32)),
            [1, 2, -np.inf, -np.inf],
            [1, 2, np.inf, np.inf],
        ),
        (rt.State(v=rt.between([-1, -2], [3, 4])), [-np.inf, -np.inf, -1, -2], [np.inf, np.inf, 3, 4]),
        (rt.State(v=rt.between(None, 3)), [-np.inf] * 4, [np.inf, np.inf, 3, 3]),
        (rt.State(q=[rt.between(0, 1), None]), [0, -np.inf, -np.inf, -np.inf], [1, np.inf, np.inf, np.inf]),
    ],
)
def test_ends_are_written_free_fixed_or_bounded(state: rt.State, lower: list[float], upper: list[float]) -> None:
    bounds = cartpole(start=state, limits=None).start_bounds
    np.testing.assert_array_equal(bounds.lower, lower)
    np.testing.assert_array_equal(bounds.upper, upper)


@pytest.mark.parametrize(
    ("duration", "bounds"),
    [
        (2, (2, 2)),
        ((0.5, 3), (0.5, 3)),
        (rt.between(0.5, 3), (0.5, 3)),
        ((0.5, None), (0.5, np.inf)),
        (np.array([1, 2]), (1, 2)),
    ],
)
def test_durations_are_fixed_or_bounded(duration: Any, bounds: tuple[float, float]) -> None:
    assert rt.Phase(BLOCK, duration).duration_bounds == bounds


def test_an_end_outside_a_limit_by_round_off_is_let_through_and_kept() -> None:
    for where in (2.0 + 1e-9, -2.0 - 1e-9):
        phase = cartpole(start=rt.State(q=[where, 0], v=0), end=None)
        nlp = nlp_of(rt.Problem([phase]), rt.Mesh(2))
        column = nlp.layouts[0].knots[0, 0]
        assert nlp.variables.lower[column] == nlp.variables.upper[column] == where


def test_two_bounds_on_one_variable_hold_both() -> None:
    more = [
        rt.constraints.JointPosition({"slider": rt.between(-1, 5)}),
        rt.constraints.JointPosition({"slider": rt.between(-9, 1.5)}),
    ]
    nlp = nlp_of(rt.Problem([cartpole(constraints=more)]), rt.Mesh(2))
    column = nlp.layouts[0].knots[1, 0]
    assert (nlp.variables.lower[column], nlp.variables.upper[column]) == (-1, 1.5)


def test_objectives_may_be_left_out() -> None:
    solution = rt.plan(cartpole(objective=None), rt.Mesh(10))
    assert solution.success and solution.objective == 0.0


def test_a_single_link_needs_no_list() -> None:
    phase = rt.Phase(rt.load("pendulum"), 1.0, objective=rt.Effort())
    assert (
        rt.Problem([phase, phase], rt.Continuity(0, 1)).links == rt.Problem([phase, phase], [rt.Continuity(0, 1)]).links
    )


def test_what_is_read_by_name_shows_its_values() -> None:
    solution = rt.plan(rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort()))
    sample = solution.at(1.0)
    assert repr(sample.x).startswith("{q.") and "<" not in repr(sample)


def test_ends_have_no_controls() -> None:
    cost = rt.Mayer(lambda start, end: end.u["u"])
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    with pytest.raises(rt.UnknownName, match="have only times, states and parameters"):
        rt.plan(rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), cost))


def test_the_docstring_of_path_constraints_lists_what_a_point_has() -> None:
    text = rt.PathConstraint.__doc__ or ""
    members = {name for name in dir(rt.dynamics.RobotPoint) if name[0] != "_"} - {"moves", "inverse_dynamics"}
    members |= {"t", "p", "q", "v", "forces"}
    assert all(f"point.{name}" in text for name in members), members


def test_the_grouped_text_counts_every_row_once() -> None:
    robot = rt.load("ur5")
    phase = rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=[1, 1, 1, 0, 0, 0.5], v=0), rt.Effort())
    every, text = str(phase).splitlines()[2:], phase.grouped
    lines = re.sub(r"\n +\(", " (", text).splitlines()[2:]
    assert len(lines) < 18 < 60 < len(every)
    more = sum(int(count) for count in re.findall(r"\(\+(\d+)\)", text))
    assert len(lines) + more == len(every)
    assert all(len(line) <= 80 for line in text.splitlines())
    assert re.search(r"position +shoulder_pan_joint \(\+2\) +end += 1 ", text)
    # Zeros of different units share a line, other values do not.
    assert re.search(r"defect +q.shoulder_pan_joint", text) and "rad, rad/s" not in text


def test_links_of_one_kind_share_a_line_of_the_grouped_text() -> None:
    robot = rt.load("ur5")
    half = rt.Phase(robot, 1.0, rt.State(q=0, v=0), objective=rt.Effort())
    problem = rt.Problem([half, half.with_(start=None, end=rt.State(v=0), name="b")], [rt.Continuity(0, 1)])
    assert len(str(problem).splitlines()) > 100 > 50 > len(problem.grouped.splitlines())
    assert problem.grouped.splitlines()[-1].split()[0] == "link"
