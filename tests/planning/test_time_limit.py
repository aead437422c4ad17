"""The time limit of a whole plan, in processor time."""

from __future__ import annotations

import time

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.progress import Deadline, TimeLimitReached
from robotraj.solvers.base import Iteration


def cartpole(**changes: object) -> rt.Phase:
    start, end = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    return rt.Phase(rt.load("cartpole"), 2.0, start, end, rt.Effort(), **changes)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"solver": rt.Ipopt()},
        {"mesh": rt.Mesh(40)},
        {"tolerance": 1e-8},
        {"continuation": [rt.planning.ContinuationStep(mesh=rt.Mesh(10))]},
    ],
    ids=["proved", "IPOPT", "mesh", "tolerance", "continuation"],
)
def test_the_last_iterate_is_kept(options: dict[str, object]) -> None:
    solution = rt.plan(cartpole(), time_limit=1e-6, check=False, **options)
    assert solution.status is rt.solvers.Status.TIME_LIMIT and not solution.success
    assert solution.message.endswith("the time limit of 1e-06 s was reached")
    assert "time_limit" in solution.status.remedy
    assert np.isfinite(solution.at(1.0).q).all()


def test_other_beginnings_are_part_of_the_plan() -> None:
    """The goal is out of reach; without a limit the plan takes many times as long."""
    far = cartpole().with_(duration=0.05)
    began = time.process_time()
    solution = rt.plan(far, time_limit=0.3, check=False)
    assert solution.status is rt.solvers.Status.TIME_LIMIT or not solution.success
    assert time.process_time() - began < 3.0


def test_a_motion_that_was_proved_in_time_is_a_success(monkeypatch: pytest.MonkeyPatch) -> None:
    goals = rt.solution.Goals(objective=1e-9)
    read = Deadline._read

    def late(self: Deadline) -> None:
        """Let the clock run out once two meshes are solved."""
        self.solves = getattr(self, "solves", 0)
        if self.solves >= 3:
            self._end = -np.inf
        read(self)

    def counted(self: Deadline) -> None:
        self.solves = getattr(self, "solves", 0) + 1
        before(self)

    before = Deadline.before_solve
    monkeypatch.setattr(Deadline, "_read", late)
    monkeypatch.setattr(Deadline, "before_solve", counted)
    solution = rt.plan(cartpole(), goals=goals, time_limit=1e3)
    assert solution.success and solution.proof is not None
    assert solution.proof.motion_holds and not solution.proof.holds
    assert "time limit" in solution.message


def test_ample_time_changes_nothing() -> None:
    assert rt.plan(cartpole(), time_limit=1e3).objective == rt.plan(cartpole()).objective


def test_the_clock_is_read_at_every_iteration() -> None:
    seen: list[Iteration] = []
    deadline = Deadline(1e-9, seen.append)
    deadline.before_solve()
    with pytest.raises(TimeLimitReached, match="1e-09 s"):
        deadline(Iteration(0, 0.0, 0.0))
    with pytest.raises(TimeLimitReached):
        deadline.before_solve()
    assert len(seen) == 1 and deadline.reached
    deadline.begin()
    deadline.before_solve()


@pytest.mark.parametrize("limit", [0.0, -1.0, "60"])
def test_a_limit_must_be_seconds_above_zero(limit: object) -> None:
    with pytest.raises(rt.InputError, match="time_limit must be above 0 s"):
        rt.plan(cartpole(), time_limit=limit)  # type: ignore[arg-type]
