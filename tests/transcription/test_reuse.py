"""Plans with other ends reuse the first transcription, and have the solution of a new one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.solvers.base import Origin
from robotraj.transcription.reuse import sharing, transcribed_again
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import GOAL, START, arm, pendulum, step, two_phases

MESH = rt.Mesh(12)
OPTIONS = {
    "solver": rt.InteriorPoint(),
    "interval_limits": rt.interval_limits.BernsteinBounds(),
    "progress": False,
    "keep_program": True,
}
"""Added rows belong to one solution; without them a plan reuses the whole NLP."""
OTHER = rt.State(q=np.add(GOAL, [-0.1, 0.05, 0.0, 0.1, 0.0, -0.2]), v=0)


def origin(solution: rt.Solution) -> Origin:
    assert solution.multipliers is not None
    assert solution.multipliers.origin is not None
    return solution.multipliers.origin


@pytest.mark.parametrize("solver", [rt.InteriorPoint(), rt.Ipopt()])
def test_a_plan_with_another_goal_is_that_of_a_new_transcription(solver: rt.InteriorPoint | rt.Ipopt) -> None:
    problem = arm()
    options = OPTIONS | {"solver": solver}
    first = rt.plan(problem, MESH, **options)
    again = rt.plan(problem.with_(end=OTHER), MESH, guess=first, **options)
    fresh = rt.plan(rt.Problem([rt.Phase(**{**vars_of(problem), "end": OTHER})]), MESH, **options)
    assert again.objective == pytest.approx(fresh.objective, rel=1e-8)
    assert not again.violations()
    np.testing.assert_allclose(again.at(again.duration).q, OTHER.q, atol=1e-9)
    assert origin(again).nlp.blocks is origin(first).nlp.blocks


def vars_of(problem: rt.Problem) -> dict[str, object]:
    (phase,) = problem.phases
    return {"subject": phase.subject, "duration": 1.0, "start": phase.start, "objective": phase.objective}


def test_the_solver_keeps_its_compiled_program() -> None:
    problem = arm()
    first = rt.plan(problem, MESH, **OPTIONS)
    again = rt.plan(problem.with_(end=OTHER), MESH, guess=first, **OPTIONS)
    assert origin(again).compiled.native is origin(first).compiled.native  # type: ignore[attr-defined]
    third = rt.plan(problem.with_(start=rt.State(q=np.add(START, 0.1), v=0)), MESH, guess=again, **OPTIONS)
    assert third.success
    assert origin(third).compiled.native is origin(first).compiled.native  # type: ignore[attr-defined]
    # An earlier solution does not change when its program solves another problem.
    np.testing.assert_allclose(first.at(first.duration).q, GOAL, atol=1e-9)
    assert np.abs(first.multipliers.rows).max() > 0  # type: ignore[union-attr]


def test_the_preparation_of_the_first_plan_is_not_counted_again() -> None:
    options = OPTIONS | {"solver": rt.Ipopt()}
    first = rt.plan(arm(), MESH, **options)
    again = rt.plan(first.problem.with_(end=OTHER), MESH, guess=first, **options)
    assert origin(again).nlp.blocks is origin(first).nlp.blocks
    assert first.times["compile"] > 0
    assert again.times["compile"] == 0
    assert min(again.times.values()) >= 0


def test_the_same_problem_again_takes_fewer_iterations() -> None:
    problem = arm()
    first = rt.plan(problem, MESH, **OPTIONS)
    again = rt.plan(problem.with_(), MESH, guess=first, **OPTIONS)
    assert again.iterations < first.iterations
    assert again.objective == pytest.approx(first.objective, rel=1e-9)


@pytest.mark.parametrize("change", ["mesh", "duration", "objective", "interval_limits"])
def test_problems_that_differ_in_more_are_transcribed_again(change: str) -> None:
    problem = arm()
    first = rt.plan(problem, MESH, **OPTIONS)
    other, mesh, options = problem, MESH, OPTIONS
    if change == "mesh":
        mesh = rt.Mesh(10)
    elif change == "duration":
        other = problem.with_(duration=1.1)
    elif change == "objective":
        other = problem.with_(objective=rt.Effort() + rt.Lagrange(lambda p: p.v[0] ** 2))
    else:
        options = OPTIONS | {"interval_limits": rt.interval_limits.ConstraintGeneration(rounds=0)}
    again = rt.plan(other, mesh, guess=first, **options)
    fresh = rt.plan(other, mesh, **options)
    assert origin(again).nlp.blocks is not origin(first).nlp.blocks
    assert again.objective == pytest.approx(fresh.objective, rel=1e-7)


def test_phases_share_what_does_not_depend_on_their_ends() -> None:
    (phase,) = arm().phases
    moved = phase.with_(end=OTHER)
    assert moved.dae is phase.dae
    assert moved.end_bounds.lower[0] == OTHER.q[0]
    assert phase.end_bounds.lower[0] == GOAL[0]


def test_several_phases_take_their_outer_ends() -> None:
    problem = two_phases().with_(start=rt.State({"x": 0.1, "v": 0}), end=rt.State({"x": 0.2, "v": 0}))
    assert problem.phases[0].start_bounds.lower.tolist() == [0.1, 0]
    assert problem.phases[1].end_bounds.lower.tolist() == [0.2, 0]
    assert rt.plan(problem, rt.Mesh(5), progress=False).success


def test_a_field_that_cannot_be_changed_is_named() -> None:
    with pytest.raises(rt.InputError, match="ambiguous: the problem has 2 phases"):
        two_phases().with_(duration=1.0)
    with pytest.raises(rt.InputError, match="objective"):
        pendulum().with_(objectives=rt.Duration())
    with pytest.raises(rt.InputError, match="outside"):
        arm().with_(end=rt.State(q=[100, 0, 0, 0, 0, 0], v=0))


def test_a_step_with_another_start_reuses_the_transcription() -> None:
    from tests.gait.test_five_link import guess

    problem = step()
    (phase,) = problem.phases
    first = rt.plan(problem, rt.Mesh(6), guess=guess(phase.robot), progress=False, keep_program=True)
    again = rt.plan(problem.with_(start=rt.State()), rt.Mesh(6), guess=first, progress=False, keep_program=True)
    assert origin(again).nlp.blocks is origin(first).nlp.blocks
    assert again.objective == pytest.approx(first.objective, rel=1e-7)


def test_several_phases_with_contacts_reuse_the_transcription() -> None:
    robot = rt.load("five_link", root="planar")
    problem, mesh = rt.gait.jump(robot, height=0.05, push=0.3, land=0.3), rt.Mesh(5)
    home = pin.centerOfMass(robot.model, robot.model.createData(), rt.gait.stand(robot))[2]
    lower = problem.with_(end=rt.State(q=rt.gait.stand(robot, height=0.95 * home), v=0))
    first = rt.plan(problem, mesh, progress=False, keep_program=True)
    again = rt.plan(lower, mesh, guess=first, progress=False, keep_program=True)
    fresh = rt.plan(lower, mesh, progress=False)
    assert origin(again).nlp.blocks is origin(first).nlp.blocks
    assert again.objective == pytest.approx(fresh.objective, rel=1e-6)
    assert again.objective != pytest.approx(first.objective, rel=1e-2)
    np.testing.assert_allclose(again.at(again.duration).q, lower.phases[-1].end.q, atol=1e-9)
    assert not again.violations()
    # An end that leaves the joints free no longer determines where the feet stand: rows are added.
    free = rt.plan(problem.with_(end=rt.State(v=0)), mesh, guess=first, progress=False)
    assert len(origin(free).nlp.rows) > len(origin(first).nlp.rows)


@pytest.mark.parametrize("gait", ["walk", "trot"])
def test_steps_of_another_length_have_the_rows_of_a_new_transcription(gait: str) -> None:
    """The length is a bound of the link and a constant of the arcs of the swinging feet."""
    robot = rt.load("five_link", root="planar") if gait == "walk" else rt.load("solo12", root="floating")
    make, size = getattr(rt.gait, gait), 1.0 if gait == "walk" else 0.15
    first, second = (
        make(robot, step_length=length * size, duration=0.6 * size**0.5, clearance=0.1 * size) for length in (0.4, 0.5)
    )
    shared = replace(second, phases=list(map(sharing, second.phases, first.phases)))
    assert shared.phases[0].dae is first.phases[0].dae
    mesh, limits, engine = rt.Mesh(3), rt.interval_limits.BernsteinBounds(), rt.engines.VirtualMachine()
    known = nlp_of(first, mesh, engine, limits)
    again = transcribed_again(known, shared, mesh, engine, limits, 0.0, known.guess)
    fresh = nlp_of(second, mesh, engine, limits)
    assert again is not None
    w = known.guess + 0.01 * np.random.default_rng(0).standard_normal(len(known.guess))
    np.testing.assert_allclose(again.values(w), fresh.values(w), rtol=1e-12, atol=1e-12)
    assert np.max(np.abs(again.values(w) - known.values(w))) > 1e-4
    for side in ("lower", "upper"):
        np.testing.assert_array_equal(getattr(again.rows, side), getattr(fresh.rows, side))
        np.testing.assert_array_equal(getattr(again.variables, side), getattr(fresh.variables, side))


def test_phases_that_differ_in_more_than_numbers_share_nothing() -> None:
    (phase,) = arm().phases
    equal = rt.Phase(phase.subject, 1.0, phase.start, OTHER, phase.objective)
    assert sharing(equal, phase).dae is phase.dae
    assert sharing(equal, phase).end_bounds.lower[0] == OTHER.q[0]
    for other in (equal.with_(duration=1.1), equal.with_(objective=2 * rt.Effort()), equal.with_(parameters={"m": 1})):
        assert sharing(other, phase) is other
    held = equal.with_(parameters={"m": rt.between(1, 2)})
    assert sharing(equal.with_(parameters={"m": 1}), equal.with_(parameters={"m": 2})).parameter_bounds.lower == [1]
    assert sharing(held, equal.with_(parameters={"m": 1})) is held


def test_a_loop_may_write_to_its_arrays() -> None:
    """Earlier phases keep their start when the array it was given in is overwritten."""
    q, weights, bounds = np.array(START), np.ones(6), {"elbow_joint": rt.between(-3, 3)}
    phase = (
        arm()
        .phases[0]
        .with_(
            start=rt.State(q=q, v=0), objective=rt.Effort(weights), constraints=[rt.constraints.JointPosition(bounds)]
        )
    )
    first = rt.plan(phase, MESH, **OPTIONS)
    q += 0.1
    weights *= 2
    bounds["elbow_joint"] = rt.between(0, 1)
    for other in (phase.with_(end=rt.State(q=GOAL, v=0)), phase.with_(duration=1.0)):
        assert other.start_bounds.lower[:6].tolist() == START
        again = rt.plan(other, MESH, guess=first, **OPTIONS)
        assert again.objective == pytest.approx(first.objective, rel=1e-8)
    (kept,) = first.problem.phases
    np.testing.assert_array_equal(kept.start.q, START)  # type: ignore[union-attr]


def moved(target: pin.SE3) -> None:
    target.translation[0] += 1.0


@pytest.mark.parametrize(
    ("given", "change", "make"),
    [
        (np.zeros(6), lambda a: a.fill(9.0), lambda a: rt.constraints.JointVelocity(rt.between(a - 1, a))),
        (np.zeros(6), lambda a: a.fill(9.0), lambda a: rt.constraints.JointVelocity(rt.between(a, None))),
        ({"x": 0.4}, dict.clear, lambda a: rt.FramePosition("tool0", a)),
        (pin.SE3.Identity(), moved, lambda a: rt.FramePose("tool0", a)),
        (pin.SE3.Identity(), moved, lambda a: rt.objectives.TerminalPose("tool0", a)),
        ([0.4, 0.0, 0.1], list.clear, lambda a: rt.objectives.TerminalPose("tool0", a)),
        ([0.5], list.clear, lambda a: rt.PathConstraint(lambda p: p.q[0], lower=a)),
        ({"v": 1.0}, dict.clear, lambda a: rt.links.Jump(0, 1, a)),
    ],
)
def test_values_keep_what_they_were_made_of(given: Any, change: Any, make: Any) -> None:
    value = make(given)
    before = repr(value)
    change(given)
    assert repr(value) == before
