"""Only linear programs without a motion are called infeasible by their relaxed rows."""

from __future__ import annotations

from typing import Any

import casadi as ca
import pytest

import robotraj as rt
from robotraj.solvers.status import Status

FORCE = {"u": rt.between(-1, 1)}


def pushed(duration: Any, rate: Any = None, **changes: Any) -> rt.Phase:
    """Move by 1 m from rest to rest with forces up to 1 N on 1 kg, which takes 2 s."""
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], (rate or (lambda p: p.u["u"]))(p)])
    ends = {"start": rt.State([0, 0]), "end": rt.State([1, 0])}
    return rt.Phase(system, duration, objective=rt.Duration(), controls=FORCE, **(ends | changes))


def verdict(problem: rt.Phase | rt.Problem) -> rt.Solution:
    return rt.plan(problem, rt.Mesh(10), check=False)


@pytest.mark.parametrize("duration", [1.8, (0.1, 1.8)])
def test_a_linear_program_without_a_motion_is_infeasible(duration: Any) -> None:
    solution = verdict(pushed(duration))
    assert solution.status is Status.INFEASIBLE and solution.conflicts[0].certain
    assert "must become" in solution.cause and abs(solution.conflicts[0].needed) == pytest.approx(1.25, rel=0.03)


def test_two_phases_of_given_durations_are_one_linear_program() -> None:
    first = pushed(0.9, end=rt.State(), name="go").with_(objective=None)
    second = pushed(0.9, start=rt.State(), name="stop").with_(objective=None)
    solution = verdict(rt.Problem([first, second], [rt.Continuity(0, 1)]))
    assert solution.status is Status.INFEASIBLE and solution.conflicts[0].certain


@pytest.mark.parametrize(
    "phase",
    [
        pushed((0.1, 1.8), start=rt.State([0, 0.1]), end=rt.State([1.5, 0.1])),
        pushed(1.8, lambda p: p.u["u"] - 0.1 * ca.tanh(p.x["v"])),
        pushed(1.8, constraints=[rt.PathConstraint(lambda p: p.u["u"] * p.x["v"], upper=9, name="power")]),
    ],
    ids=["a free duration without rest", "dynamics that are not linear", "a row that is not linear"],
)
def test_other_problems_are_not(phase: rt.Phase) -> None:
    solution = verdict(phase)
    assert solution.status is Status.NOT_FOUND and solution.conflicts and not solution.conflicts[0].certain
    assert "may have to become" in solution.cause
