"""Joints that the least time leaves free have smooth torques, and the time stays the least."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.refinement.objective_quadrature import smoothing_cost, squares_cost
from robotraj.transcription.smoothness.roughness import roughness


@pytest.fixture(scope="module")
def around_a_post() -> rt.Phase:
    ends = [[side, -1.8, 1.6, -1.2, -1.57, 0.0] for side in (-1.1, 1.1)]
    post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47))
    return rt.Phase(
        rt.load("ur5"),
        (0.2, 5.0),
        *(rt.State(q=q, v=0) for q in ends),
        rt.Duration(),
        [rt.CollisionFree([post], margin=0.01)],
    )


def test_torques_have_no_teeth_and_the_time_is_the_same(around_a_post: rt.Phase) -> None:
    """Only the base determines the time; the other joints are free while it turns."""
    smooth = rt.plan(around_a_post)
    rough = rt.plan(around_a_post, smoothing=0.0)
    assert smooth.proof is not None and rough.proof is not None
    assert smooth.proof.roughness < 0.01 and smooth.proof.holds
    assert rough.proof.roughness > 0.08 and not rough.proof.holds
    assert rough.proof.verdict == "motion proved, controls with teeth"
    count = smooth.refinement[-1].intervals
    (on_same_mesh,) = {step.objective for step in rough.refinement if step.intervals == count}
    assert smooth.objective == pytest.approx(on_same_mesh, rel=1e-5)
    assert smooth.settings is not None and "smoothest" in smooth.settings.reasons["smoothing"]


def test_torques_that_alternate_nevertheless_are_solved_again_with_more_weight(around_a_post: rt.Phase) -> None:
    """A weight of 1e-5 leaves teeth above 2 percent; six times as much leaves none, and the time stays."""
    solution = rt.plan(around_a_post, smoothing=1e-5)
    assert solution.proof is not None and solution.proof.is_smooth and solution.proof.holds
    assert [step.intervals for step in solution.refinement[-2:]] == [48, 48]
    before, after = (step.objective for step in solution.refinement[-2:])
    assert after == pytest.approx(before, rel=1e-4)


def test_the_objective_is_the_duration_alone(around_a_post: rt.Phase) -> None:
    solution = rt.plan(around_a_post.with_(constraints=[]), rt.Mesh(10), smoothing=0.1)
    part = solution.phases[0]
    assert solution.objective == pytest.approx(solution.duration, abs=1e-12)
    # Simpson's rule on the mean of the squares of six torques relative to their limits.
    sample = [solution.at(t) for t in np.linspace(0.0, solution.duration, 21)]
    assert part.phase.robot is not None
    squares = [np.mean((each.tau / part.phase.robot.limits.effort) ** 2) for each in sample]
    weights = np.tile([1.0, 4.0, 1.0], (10, 1)) / 60.0 * solution.duration
    simpson = sum(weights[k] @ squares[2 * k : 2 * k + 3] for k in range(10))
    cost = squares_cost(part.phase, part.trajectory, part.mesh.schemes, 0.1)
    assert cost == pytest.approx(0.1 * simpson, rel=1e-3)


def test_the_loss_of_a_double_integrator_is_of_second_order() -> None:
    """A unit force moves a unit mass by 1 in 2 s; the linear part of the control near the switch costs time."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    move = rt.Phase(
        block,
        (0.5, 5.0),
        rt.State({"x": 0.0, "v": 0.0}),
        rt.State({"x": 1.0, "v": 0.0}),
        rt.Duration(),
        controls={"u": rt.between(-1, 1)},
    )
    lost = [rt.plan(move, rt.Mesh(120), smoothing=each).duration / 2.0 - 1.0 for each in (0.2, 0.1)]
    # With costate of slope 2 / T around the switch, u is linear over a share 2 epsilon of the motion.
    assert 3.0 < lost[0] / lost[1] < 5.0
    assert lost[1] < 0.1**2


def test_efforts_and_given_meshes_are_not_smoothed(around_a_post: rt.Phase) -> None:
    free = around_a_post.with_(constraints=[])
    on_mesh = rt.plan(free, rt.Mesh(6))
    assert on_mesh.settings is not None and on_mesh.settings.smoothing == 0.0
    effort = free.with_(duration=1.2, objective=rt.Effort())
    part = rt.plan(effort, rt.Mesh(6), smoothing=0.1).phases[0]
    assert smoothing_cost(part.phase, part.trajectory, part.mesh.schemes, 0.1) == 0.0


@pytest.mark.parametrize("share", [-0.1, 2.0, "much"])
def test_a_weight_is_a_share(around_a_post: rt.Phase, share: object) -> None:
    with pytest.raises(rt.InputError, match="smoothing= is a share from 0 to 1"):
        rt.plan(around_a_post, smoothing=share)  # type: ignore[arg-type]


def test_other_smoothing_needs_another_program(around_a_post: rt.Phase) -> None:
    """A warm start on the same mesh does not keep the objective of the program before."""
    free = around_a_post.with_(constraints=[])
    first = rt.plan(free, rt.Mesh(10))
    again = rt.plan(free, rt.Mesh(10), guess=first, smoothing=0.05)
    afresh = rt.plan(free, rt.Mesh(10), smoothing=0.05)
    first, second = (
        roughness(each.phase, each.trajectory, each.inputs) for each in (again.phases[0], afresh.phases[0])
    )
    assert first == pytest.approx(second, abs=1e-4)
    assert again.settings == replace(again.settings, smoothing=0.05)
