"""Stated values are tried, and larger ones are stated where they do not suffice."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import robotraj as rt
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.relaxation.stated_values import CLOSE, SHORT_OF_ENOUGH, sufficient
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict

SPEED = Conflict("move", "state bound, v", 0.5, 0.8, 1.2, "", 0.5)
THRUST = Conflict("move", "control bound, u", 0.0, -2.0, -3.0, "", 0.5)
LONG = Conflict("move", "duration", 2.0, 1.0, 2.0, "s", 1.0, True, "alone suffices")


def move() -> Problem:
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    bounds = {"states": {"v": rt.between(-0.5, 0.8)}, "controls": {"u": rt.between(-2, 2)}}
    effort = rt.Lagrange(lambda p: p.u["u"] ** 2)
    return Problem([rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), effort, name="move", **bounds)])


class Trial(CoarseSolves):
    """A trial that answers without a solve."""

    def __init__(self, answer: Callable[[Problem], bool]) -> None:
        object.__setattr__(self, "answer", answer)

    def has_motion(self, problem: Problem) -> bool:
        return bool(self.answer(problem))


def bounds_of(problem: Problem) -> tuple[float, ...]:
    low, high = problem.phases[0].rows.limits()["v"]
    return (low, high, problem.phases[0].rows.limits()["u"][1], problem.phases[0].duration_bounds[1])


def test_values_that_suffice_are_kept_and_bounds_of_both_sides_widen_together() -> None:
    tried: list[tuple[float, ...]] = []

    def attempt(problem: Problem) -> bool:
        tried.append(bounds_of(problem))
        return True

    assert set(sufficient((SPEED, THRUST, LONG), move(), Trial(attempt))) == {SPEED, THRUST, LONG}
    assert tried == [(-0.5, 1.2, 3.0, 1.0), (-0.5, 0.8, 2.0, 2.0)]


@pytest.mark.parametrize("least", [1.19, 1.25, 1.5, 2.9])
def test_about_the_least_multiple_that_suffices_is_stated(least: float) -> None:
    speed, longer = sufficient((SPEED, LONG), move(), Trial(lambda p: bounds_of(p)[1] > least or bounds_of(p)[3] > 2.2))
    assert max(least, 1.2) <= speed.needed <= max(0.8 + CLOSE * (least - 0.8), 1.2)
    assert 2.2 < longer.needed <= 2.2 * CLOSE
    assert not speed.certain and not longer.certain


def test_values_that_were_tried_are_certain_where_a_theorem_excludes_the_given_ones() -> None:
    speed, longer = sufficient(
        (SPEED, LONG), move(), Trial(lambda p: bounds_of(p)[1] > 1.5 or bounds_of(p)[3] > 2.2), True
    )
    assert speed.certain and longer.certain
    (failed,) = sufficient((SPEED, LONG), move(), Trial(lambda _: False), True)
    assert not failed.certain and failed.reason == SHORT_OF_ENOUGH


def test_a_duration_that_suffices_alone_stands_before_rows_that_suffice_together_or_not_at_all() -> None:
    assert sufficient((SPEED, THRUST, LONG), move(), Trial(lambda _: True)) == (LONG, SPEED, THRUST)
    first, second = sufficient((SPEED, LONG), move(), Trial(lambda p: bounds_of(p)[3] > 1.9))
    assert first == LONG and second.reason == SHORT_OF_ENOUGH


def test_where_none_suffices_rows_say_so_and_durations_are_left_out() -> None:
    (only,) = sufficient((SPEED, LONG), move(), Trial(lambda _: False))
    assert only.needed == 1.2 and only.reason == SHORT_OF_ENOUGH


def test_limits_of_robots_and_of_tools_are_widened() -> None:
    arm = rt.load("two_link_arm")
    slow = rt.constraints.FrameSpeed("tip", linear=0.1)
    phase = rt.Phase(arm, 2.0, rt.State(q=[0, 0], v=0), rt.State(q={"shoulder": 1}, v=0), None, [slow], name="move")
    tool = Conflict("move", "linear speed, tip", 1.0, 0.1, 0.3, "m/s", 2.0)
    motor = Conflict("move", "effort limit, elbow", 1.0, -1.0, -4.0, "N m", 3.0)
    seen: list[Problem] = []
    sufficient((tool, motor), Problem([phase]), Trial(lambda p: seen.append(p) is None))
    rows = {row.label: row for row in seen[0].phases[0].rows}
    assert rows["linear speed, tip"].shown(rows["linear speed, tip"].upper) == pytest.approx(0.3)
    assert (rows["effort limit, elbow"].lower, rows["effort limit, elbow"].upper) == (-4.0, 4.0)
    assert rows["effort limit, shoulder"].upper == 1.0


@pytest.mark.slow
def test_a_slow_tool_has_time_enough_in_the_stated_duration() -> None:
    """The coarse mesh of the relaxed problem exceeds the speed between its points, and finds 2.5 s for this arm."""
    arm = rt.load("ur5")
    start, end = [0.2, -1.2, 1.0, -0.5, 0.3, 0.0], [-0.6, -0.7, 0.4, 0.4, -0.2, 0.5]
    slow = rt.constraints.FrameSpeed("tool0", angular=0.5)
    phase = rt.Phase(arm, 1.0, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort(), [slow])
    failed = rt.plan(phase, check=False)
    longer = next(each for each in failed.conflicts if each.name == "duration")
    assert rt.plan(phase.with_(duration=longer.needed), check=False).success
