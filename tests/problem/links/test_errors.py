"""Errors of links that cannot hold name the phase, state or parameter."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from tests.programs import nlp_of

OTHER = rt.System(["y"], ["u"], lambda point: [point.u["u"]])


def refused(phases: Any, link: Any, kind: type[Exception] = rt.InputError) -> str:
    with pytest.raises(kind) as caught:
        rt.Problem(phases, [link])
    return str(caught.value)


@pytest.mark.parametrize(
    "link",
    [
        rt.Continuity(0, 2),
        rt.links.Jump(2, 1),
        rt.links.EqualDuration(0, 2),
        rt.links.Linkage((0, 2), lambda a, b: 0),
        rt.Periodic(last=2),
        rt.Mirror(first=2),
        rt.links.SameParameter("p", (0, 2)),
    ],
    ids=lambda link: type(link).__name__,
)
def test_a_phase_that_does_not_exist(push: Any, link: Any) -> None:
    phases = [push.phase(parameters={"p": 1.0}), push.phase(parameters={"p": 1.0})]
    assert "names phase 2; the problem has phases 0 to 1" in refused(phases, link)


def test_links_name_phases_by_their_numbers(push: Any) -> None:
    phases = [push.phase(name="ride"), push.phase(name="rest")]
    assert "names phase 'ride'; the problem has phases 0 to 1. Give the number of a phase." in refused(
        phases, rt.Continuity("ride", "rest")
    )


@pytest.mark.parametrize("link", [rt.Continuity(0, 1), rt.links.Jump(0, 1), rt.Periodic()], ids=str)
def test_phases_of_other_states_are_named_with_their_states(push: Any, link: Any) -> None:
    phases = [push.phase(name="ride"), rt.Phase(OTHER, 1.0, name="walk")]
    message = refused(phases, link)
    for part in ("'ride'", "'walk'", "['x', 'v']", "['y']"):
        assert part in message


def test_a_state_that_does_not_exist_lists_the_valid_ones(push: Any) -> None:
    phases = [push.phase(), push.phase()]
    message = refused(phases, rt.links.Jump(0, 1, {"w": 1.0}))
    assert "'w'" in message and "x" in message and "v" in message
    assert "'w'" in refused(phases, rt.Periodic({"w": 1.0}))


def test_a_period_of_a_phase_by_its_number_is_an_error_that_names_the_remedy(push: Any) -> None:
    assert "Phases are named by first= and last=" in refused([push.phase()], rt.Periodic(0))  # type: ignore[arg-type]


def test_phases_that_are_no_sequence_show_how_a_linkage_is_written() -> None:
    with pytest.raises(rt.InputError, match=r"phases is 0; it must be a sequence .* Linkage\(\(0, 1\), lambda a, b"):
        rt.links.Linkage(0, 1, lambda a, b: 0)  # type: ignore[arg-type]


def test_jumps_that_are_no_mapping_show_how_they_are_written() -> None:
    with pytest.raises(rt.InputError, match=r"jumps of Jump\(0, 1\) must map names .*; got 3"):
        rt.links.Jump(0, 1, 3)  # type: ignore[arg-type]


def test_a_parameter_that_a_phase_lacks_names_the_phase(push: Any) -> None:
    phases = [push.phase(parameters={"mass": 1.0}), push.phase(name="coast", parameters={"drag": 1.0})]
    message = refused(phases, rt.links.SameParameter("mass", (0, 1)), rt.UnknownName)
    assert "'mass'" in message and "'coast'" in message and "drag" in message
    assert "at least two phases must" in refused(phases, rt.links.SameParameter("mass"))


def test_a_mirror_of_a_joint_that_does_not_exist(push: Any) -> None:
    robot = rt.Phase(rt.load("two_link_arm"), 1.0)
    message = refused([robot], rt.Mirror({"shoulder": "wrist"}), rt.UnknownName)
    assert "'wrist'" in message and "elbow" in message
    assert "'w'" in refused([push.phase()], rt.Mirror(negated=["w"]), rt.UnknownName)


def test_a_link_that_binds_nothing(push: Any) -> None:
    assert "leaves every state free" in refused([push.phase()], rt.Periodic({"x": None, "v": None}))


def test_bounds_of_another_length_than_the_linkage(push: Any) -> None:
    message = refused([push.phase()], rt.links.Linkage((0,), lambda a: [a.end.t, a.start.t], [0, 0, 0], name="clock"))
    assert "'clock'" in message and "2 rows" in message and "3 values" in message


def test_a_bound_that_is_not_a_number(push: Any) -> None:
    assert "NaN" in refused([push.phase()], rt.links.Linkage((0,), lambda a: a.end.t, np.nan, name="clock"))


def test_controls_are_not_known_at_the_ends(push: Any) -> None:
    with pytest.raises(rt.RobotrajError, match="u"):
        rt.Problem([push.phase()], [rt.links.Linkage((0,), lambda a: a.end.u["u"])])


def test_what_is_no_link_is_refused(push: Any) -> None:
    assert "'next' in the links of the problem is not a link" in refused([push.phase()], "next")


def test_the_rows_of_links_are_printed_and_named(push: Any) -> None:
    phases = [push.phase(name="out"), push.phase(name="home")]
    problem = rt.Problem(phases, [rt.Continuity(0, 1), rt.links.EqualDuration(0, 1)])
    printed = str(problem)
    assert "link Continuity(0, 1)  continuity, v     = 0  m/s" in printed
    assert "link equal duration    equal duration    = 0  s" in printed
    closed = rt.links.Linkage((0,), lambda a: a.end.x["x"] - a.start.x["x"], name="closed")
    assert str(rt.Problem([push.phase()], [closed])).endswith("link closed  closed  = 0")  # no unit in the whole table
    names = nlp_of(problem, rt.Mesh(2)).row_names
    assert sum("continuity" in name for name in names) == 3
    assert sum("equal duration" in name for name in names) == 1


def test_contradicting_links_are_infeasible_and_say_which_row(push: Any) -> None:
    phases = [push.phase(1.0, [0, 0], {"x": 1}), push.phase(1.0, {"x": 2})]
    with pytest.raises(rt.NoSolutionFound) as caught:
        push.plan(phases, [rt.Continuity(0, 1)])
    assert not caught.value.solution.success
    assert any("continuity" in str(violation) for violation in caught.value.solution.violations(10))


@pytest.mark.parametrize("link", [rt.Continuity(0, 0), rt.Continuity(1, 0), rt.links.Jump(-1, 0), rt.Continuity(1, -1)])
def test_time_runs_on_into_a_later_phase(link: rt.links.Link) -> None:
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    phases = [rt.Phase(system, 1.0, name=name) for name in ("there", "back")]
    with pytest.raises(rt.InputError, match=r"must be later than the first.*rt.Periodic"):
        rt.Problem(phases, [link])


def test_feet_come_down_in_a_later_phase_or_into_the_image_of_the_first() -> None:
    robot = rt.load("five_link", root="planar")
    step = rt.gait.walk(robot, step_length=0.4, duration=0.6)
    with pytest.raises(rt.InputError, match=r"Touchdown\(0, 0\): the second phase must be later"):
        rt.Problem(step.phases, [rt.Touchdown(0, 0)])
