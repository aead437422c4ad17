"""What a second solve gains is what the plan has missed, by closed forms."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

import robotraj as rt
from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.witness.claims.optimum import optimum
from robotraj.witness.cost.second_solve import SecondSolve, second_solve
from tests.lies import elsewhere

FAR, PUSH = 2.0, 0.5


def mass(objective: rt.Objective, duration: float | tuple[float, float]) -> rt.Phase:
    """A mass of 1 kg is moved by ``FAR`` from rest to rest by at most ``PUSH``, at best in 2 sqrt(FAR / PUSH)."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    limits = {"u": rt.between(-PUSH, PUSH)}
    return rt.Phase(system, duration, rt.State([0, 0]), rt.State([FAR, 0]), objective, controls=limits)


LEAST = 2.0 * (FAR / PUSH) ** 0.5


@cache
def least_time() -> rt.Solution:
    return rt.plan(mass(rt.Duration(), (1.0, 20.0)), progress=False)


def slower(share: float) -> rt.Solution:
    """A motion that takes longer by a share, with the proof of the fastest one."""
    slow = rt.plan(mass(rt.Effort(), (1.0 + share) * LEAST), progress=False)
    told = elsewhere(slow, lambda _: least_time().problem.phases[0])
    return replace(told, objective=told.duration, proof=least_time().proof)


def claim_of(report: object) -> Claim:
    return next(claim for claim in report.claims if claim.name == "optimum")  # type: ignore[attr-defined]


@pytest.mark.parametrize("share", [0.005, 0.05, 0.5])
def test_the_gain_is_the_time_that_was_lost(share: float) -> None:
    found = second_solve(slower(share), 3e-3)
    assert found.before == pytest.approx((1.0 + share) * LEAST, rel=1e-6)
    assert found.after == pytest.approx(LEAST, rel=1e-3)
    assert found.gain == pytest.approx(share / (1.0 + share), abs=1e-3)
    assert found.better is not None and found.better.duration == found.after


def test_an_optimum_gains_nothing() -> None:
    found = second_solve(least_time(), 3e-3)
    assert found.better is None and found.gain < 1e-3 and not found.reason


def test_a_motion_that_costs_less_refuses_the_plan() -> None:
    report = rt.validate(slower(0.05))
    assert not report.passed and claim_of(report).judgement is Judgement.FAILS
    assert "no optimum" in claim_of(report).notes[0]
    assert claim_of(rt.validate(slower(0.05), optimum=None)).judgement is Judgement.NOT_JUDGED
    assert claim_of(rt.validate(slower(0.05), optimum=0.1)).holds


def test_a_plan_that_claims_no_optimum_is_not_solved_again() -> None:
    report = rt.validate(replace(slower(0.05), proof=None))
    assert report.second is None and claim_of(report).judgement is Judgement.NOT_JUDGED


def test_a_better_motion_that_may_not_be_used_refuses_nothing() -> None:
    report = rt.validate(least_time())
    kept = SecondSolve(4.0, 3.0, 0.25, faults=("Links of the robot overlap.",))
    claim = optimum(replace(report, second=kept), report.tolerances)
    assert claim.judgement is Judgement.NOT_JUDGED and "overlap" in claim.notes[0]


def test_a_solve_that_does_not_converge_judges_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotraj.witness.cost.finer_motions.PATIENCE", 2)
    found = second_solve(slower(0.5), 3e-3)
    assert found.better is None and "did not converge" in found.reason


def test_a_looser_goal_of_the_proof_is_the_bound() -> None:
    told = slower(0.05)
    assert told.proof is not None
    loose = replace(told, proof=replace(told.proof, goals=rt.solution.Goals(objective=0.1)))
    assert claim_of(rt.validate(loose)).bound == 0.1 and claim_of(rt.validate(loose)).holds


def test_a_second_solve_ends_with_the_clock() -> None:
    class Late(Exception):
        pass

    def clock() -> None:
        raise Late

    with pytest.raises(Late):
        second_solve(least_time(), 3e-3, clock)


@pytest.mark.slow
def test_a_plan_with_dry_friction_beside_its_own_body_is_judged() -> None:
    """Without rows on its links the second solve would save 1 percent by a way through the base."""
    robot = rt.load("xarm7")
    assert robot.friction.any()
    start, end = [-0.83, 1.07, -1.65, 1.64, -0.11, 0.17, 0.4], [0.01, 1.4, 1.39, 1.66, -0.92, 0.89, 1.35]
    ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
    solution = rt.plan(rt.Phase(robot, 2.19, *ends, rt.Effort()), progress=False)
    found = second_solve(solution, 3e-3)
    assert not found.reason and found.better is None and found.gain < 3e-3
