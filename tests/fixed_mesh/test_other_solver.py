"""The other solver gets what one solver did not solve, where it may help."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

import robotraj as rt
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp


@dataclass(frozen=True)
class Counted(Solver):
    """IPOPT, which counts its solves."""

    solves: list[int] = field(default_factory=list)
    limits: list[float] = field(default_factory=list)

    def within(self, seconds: float) -> Counted:
        self.limits.append(seconds)
        return self

    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        outcome = rt.Ipopt().solve(nlp, progress, multipliers)
        self.solves.append(outcome.iterations)
        return outcome


def arm(duration: object, effort: float = 5.0) -> rt.Phase:
    robot = rt.load("two_link_arm")
    ends = rt.State(q=[0.5, 0.5], v=0), rt.State(q=[1.5, -0.5], v=0)
    return rt.Phase(robot, duration, *ends, rt.Effort(), limits=robot.limits.with_(effort=effort))


def block(duration: object) -> rt.Phase:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    ends = rt.State([0, 0]), rt.State([10, 0])
    return rt.Phase(system, duration, *ends, rt.Duration(), controls={"u": rt.between(-1, 1)})


def planned(phase: rt.Phase, other: Counted, **options: object) -> rt.Solution:
    return rt.plan(phase, rt.Mesh(8), solver=rt.InteriorPoint(fallback=other, **options), check=False)


@pytest.mark.parametrize("phase", [block((0.5, 1.0)), block(1.0)], ids=["free duration", "a system"])
def test_an_infeasible_problem_has_a_second_opinion_where_other_guesses_may_help(phase: rt.Phase) -> None:
    other = Counted()
    solution = planned(phase, other)
    assert solution.status is Status.INFEASIBLE and solution.conflicts
    # Restarts have none of their own.
    assert len(other.solves) == 1
    assert solution.iterations > other.solves[0]
    assert "since the interior-point method ended with" in solution.message


def test_an_arm_with_a_fixed_duration_needs_none() -> None:
    other = Counted()
    solution = planned(arm(0.8), other)
    assert solution.status is Status.NOT_FOUND and solution.conflicts
    assert not other.solves and solution.message == "interior point: infeasible"


def test_the_second_opinion_gets_the_time_that_is_left() -> None:
    other = Counted()
    planned(block(1.0), other, time_limit=50.0)
    assert other.limits and all(0 < seconds < 50 for seconds in other.limits)
