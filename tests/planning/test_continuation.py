"""Continuation steps: easier problems first, the problem itself last, and a record of each."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName


@pytest.fixture(scope="module")
def arm() -> rt.Robot:
    return rt.load("two_link_arm")


def reach(arm: rt.Robot, **changes: object) -> rt.Phase:
    given = dict(
        duration=5.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=[0.5, 0.5], v=0),
        objective=rt.Effort(),
        constraints=[rt.PathConstraint(lambda p: p.v[0], upper=0.15, name="slow shoulder", unit="rad/s")],
        name="reach",
    )
    return rt.Phase(arm, **(given | changes))


def test_the_last_step_is_the_problem_itself(arm: rt.Robot) -> None:
    phase = reach(arm)
    direct = rt.plan(phase, mesh=rt.Mesh(20))
    staged = rt.plan(
        phase,
        mesh=rt.Mesh(20),
        continuation=[
            rt.planning.ContinuationStep(mesh=rt.Mesh(5), constraints=(), name="coarse and free"),
            rt.planning.ContinuationStep(mesh=rt.Mesh(5)),
        ],
    )
    assert staged.problem.phases[0] is phase
    assert staged.objective == pytest.approx(direct.objective, rel=1e-7)
    assert len(staged.phases[0].knots) == 21
    first, second = staged.continuation
    assert (first.name, second.name) == ("coarse and free", "step 2")
    assert first.status is second.status is rt.solvers.Status.SOLVED
    assert first.objective < second.objective - 1e-6
    assert "coarse and free: solved" in str(staged)
    assert direct.continuation == ()


def test_effort_before_absolute_power(arm: rt.Robot) -> None:
    phase = reach(arm, objective=rt.objectives.AbsolutePower(), constraints=[])
    staged = rt.plan(phase, mesh=rt.Mesh(30), continuation=[rt.planning.ContinuationStep(objective=rt.Effort())])
    effort = rt.plan(reach(arm, constraints=[]), mesh=rt.Mesh(30))
    assert staged.continuation[0].objective == pytest.approx(effort.objective, rel=1e-9)
    # The least power is at most that of the motion of least effort, from which it is sought.
    times = np.linspace(0.0, effort.duration, 20_001)
    motion = effort.at(times)
    assert staged.objective <= np.trapezoid(np.abs(motion.tau * motion.v).sum(axis=1), times)
    assert rt.plan(phase, mesh=rt.Mesh(30), guess=staged).objective == pytest.approx(staged.objective, rel=1e-6)


def test_limits_and_objective_can_be_dropped_for_a_step(arm: rt.Robot) -> None:
    phase = reach(arm)
    stage = rt.planning.ContinuationStep(limits=None, objective=None).of(rt.Problem([phase])).phases[0]
    assert stage.limits is None and stage.objective is None
    assert [c.name for c in stage.bound_constraints] == ["slow shoulder"]


def test_phases_are_changed_by_name(arm: rt.Robot) -> None:
    out = reach(arm, name="out")
    back = reach(arm, name="back", start=None, end=rt.State(q=0, v=0))
    problem = rt.Problem([out, back], [rt.Continuity(0, 1)])
    changed = rt.planning.ContinuationStep(constraints={"back": ()}).of(problem)
    assert changed.phases[0].constraints == out.constraints
    assert changed.phases[1].constraints == ()
    assert rt.plan(
        problem, mesh=rt.Mesh(5), continuation=[rt.planning.ContinuationStep(constraints={"back": ()})]
    ).success
    with pytest.raises(UnknownName, match="bakc"):
        rt.planning.ContinuationStep(constraints={"bakc": ()}).of(problem)


def test_a_step_that_changes_nothing_is_the_problem(arm: rt.Robot) -> None:
    problem = rt.Problem([reach(arm)])
    assert rt.planning.ContinuationStep(mesh=rt.Mesh(5)).of(problem) is problem


def test_a_step_that_fails_is_recorded_and_left_behind(arm: rt.Robot) -> None:
    impossible = rt.PathConstraint(lambda p: 1.0 + p.a[0] ** 2, upper=0.5, name="never")
    phase = reach(arm)
    stages = [
        rt.planning.ContinuationStep(constraints=[impossible]),
        rt.planning.ContinuationStep(solver=rt.Ipopt(max_iterations=1)),
    ]
    solution = rt.plan(phase, mesh=rt.Mesh(10), continuation=stages)
    assert [record.status for record in solution.continuation] == [
        rt.solvers.Status.INFEASIBLE,
        rt.solvers.Status.ITERATION_LIMIT,
    ], solution
    assert solution.success
    direct = rt.plan(phase, mesh=rt.Mesh(10))
    assert solution.iterations == direct.iterations
    np.testing.assert_allclose(solution.objective, direct.objective, rtol=1e-10)


def test_steps_lead_to_a_tolerance(arm: rt.Robot) -> None:
    solution = rt.plan(
        reach(arm), tolerance=1e-5, continuation=[rt.planning.ContinuationStep(mesh=rt.Mesh(5), constraints=())]
    )
    assert solution.success and solution.refinement and solution.continuation


def test_what_is_no_step_is_refused(arm: rt.Robot) -> None:
    with pytest.raises(InputError, match="number 0 is a Mesh"):
        rt.plan(reach(arm), continuation=[rt.Mesh(5)])


def test_an_interrupted_step_ends_the_plan(arm: rt.Robot) -> None:
    class Interrupts(rt.Ipopt):
        def solve(self, nlp: Any, progress: Any = None, multipliers: Any = None) -> Any:
            outcome = super().solve(nlp, progress, multipliers)
            return replace(outcome, status=rt.solvers.Status.INTERRUPTED)

    stages = [
        rt.planning.ContinuationStep(mesh=rt.Mesh(5), name="first"),
        rt.planning.ContinuationStep(solver=Interrupts()),
        rt.planning.ContinuationStep(name="third"),
    ]
    solution = rt.plan(reach(arm), rt.Mesh(8), continuation=stages, check=False, progress=False)
    assert solution.status is rt.solvers.Status.INTERRUPTED
    assert [record.status for record in solution.continuation] == [
        rt.solvers.Status.SOLVED,
        rt.solvers.Status.INTERRUPTED,
    ]
    assert np.isfinite(solution.at(1.0).q).all()
