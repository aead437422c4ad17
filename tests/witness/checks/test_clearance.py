"""Exact shapes along a plan: collisions that the planner does not know are found and named."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.collision.own_body import own_body
from robotraj.solution.claims.claim import Judgement
from robotraj.witness.checks.clearance import clearance_of

START, GOAL = (-1.1, -1.8, 1.6, -1.2, -1.57, 0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)
BOX = rt.obstacles.Box((0.1, 0.1, 0.3), (0.52, 0.07, 0.47), name="post")


@pytest.fixture(scope="module")
def free_plan() -> rt.Solution:
    ends = rt.State(q=START, v=0), rt.State(q=GOAL, v=0)
    return rt.plan(rt.Phase(rt.load("ur5"), 1.0, *ends, rt.Effort()), mesh=rt.Mesh(12))


def seen_with(solution: rt.Solution, *obstacles: rt.obstacles.Obstacle, margin: float = 0.0) -> list:
    """What the witness finds of the solution's motion among obstacles that it was not planned with."""
    return seen(solution, rt.CollisionFree(obstacles, margin, self_collision=False))


def seen(solution: rt.Solution, free: rt.CollisionFree) -> list:
    """What the witness finds of the solution's motion under a constraint that it was not planned with."""
    part = solution.phases[0]

    class Planned:
        phase = part.phase.with_(constraints=[])
        knots = part.knots

        def at(self, *arguments, **options):
            return part.at(*arguments, **options)

    planned = Planned()
    object.__setattr__(planned.phase, "constraints", (free,))
    nearest, broken, _ = clearance_of(planned)
    return nearest, broken


def test_a_post_in_the_way_is_named_with_its_link_and_time(free_plan: rt.Solution) -> None:
    robot = free_plan.phases[0].phase.robot
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, free_plan.at(0.5).q)
    post = rt.obstacles.Box((0.1, 0.1, 0.3), data.oMf[robot.frame("tool0")].translation, name="post")
    (nearest,), violations = seen_with(free_plan, post)
    assert nearest.distance < 0.0 and nearest.label.endswith("and post")
    assert violations and all(violation.name == "clearance" for violation in violations)
    assert "post" in str(violations[0]) and violations[0].relative > 1e-3


def test_a_margin_from_an_obstacle_holds_also_where_no_configuration_keeps_it(free_plan: rt.Solution) -> None:
    """Only links that are always near each other are let off the margin."""
    (nearest,), violations = seen_with(free_plan, rt.obstacles.Sphere(0.05, (0.5, 0.0, 1.1)), margin=4.0)
    assert nearest.margin == 4.0 and violations
    assert max(violation.amount for violation in violations) == pytest.approx(4.0 - nearest.distance)


def test_pairs_of_the_srdf_are_not_measured(free_plan: rt.Solution) -> None:
    (nearest,), _ = seen(free_plan, rt.CollisionFree())
    pair = tuple(nearest.label.split(" and "))
    (other,), _ = seen(free_plan, rt.CollisionFree(srdf=[pair]))
    assert other.label != nearest.label and other.distance > nearest.distance


def test_the_nearest_pair_is_the_one_with_the_least_excess_over_its_margin(free_plan: rt.Solution) -> None:
    """Links that are always near are nearer than the pair that violates the margin, and violate none."""
    free = rt.CollisionFree(margin=0.2, srdf=[("upper_arm_link", "base_link")])
    (nearest,), violations = seen(free_plan, free)
    assert violations and nearest.distance < nearest.margin
    assert max(violation.amount for violation in violations) == pytest.approx(nearest.margin - nearest.distance)


@pytest.mark.parametrize("moving", [6, 1], ids=["every joint", "the first joint alone"])
def test_a_motion_that_rests_at_every_knot_is_measured_between_them(moving: int) -> None:
    whole = rt.load("ur5")
    arm = rt.load("ur5", locked=dict(zip(whole.joint_names[moving:], START[moving:], strict=True)))
    phase = rt.Phase(arm, 1.0, rt.State(q=START[:moving], v=0), rt.State(q=GOAL[:moving], v=0), rt.Effort())
    plan = rt.plan(phase, mesh=rt.Mesh(1, rt.schemes.LobattoIIIA(6)))
    robot = phase.robot
    assert robot is not None
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, plan.at(0.5).q)
    ball = rt.obstacles.Sphere(0.05, data.oMf[robot.frame("tool0")].translation)
    (nearest,), violations = seen_with(plan, ball)
    assert nearest.distance < 0.0 and violations


def test_the_smallest_distance_is_that_of_dense_samples(free_plan: rt.Solution) -> None:
    far = rt.obstacles.Sphere(0.05, (0.5, 0.0, 1.1))
    (nearest,), violations = seen_with(free_plan, far)
    (again,), short = seen_with(free_plan, far, margin=nearest.distance + 0.01)
    assert not violations and short
    assert again.distance == pytest.approx(nearest.distance)
    # At its time no other sample of the motion is nearer: a ball grown by the distance just touches.
    grown = rt.obstacles.Sphere(0.05 + nearest.distance + 1e-4, (0.5, 0.0, 1.1))
    assert seen_with(free_plan, grown)[1]
    shrunk = rt.obstacles.Sphere(0.05 + nearest.distance - 1e-3, (0.5, 0.0, 1.1))
    assert not seen_with(free_plan, shrunk)[1]


def test_a_margin_that_is_broken_for_a_moment_only_is_seen(free_plan: rt.Solution) -> None:
    """A pair far from its obstacle is evaluated again before it can come nearer than the margin."""
    robot, times = free_plan.phases[0].phase.robot, np.linspace(0.0, 1.0, 4001)
    data = robot.model.createData()
    frame = robot.frame("tool0")
    tool = np.array(
        [
            pin.updateFramePlacement(robot.model, data, frame).translation.copy()
            for q in free_plan.at(times).q
            if pin.forwardKinematics(robot.model, data, q) is None
        ]
    )
    centre = tool[2000] + np.array([0.0, 0.0, 0.4])
    ball = rt.obstacles.Sphere(0.02, centre)
    (nearest,), _ = seen_with(free_plan, ball)
    _, violations = seen_with(free_plan, ball, margin=nearest.distance + 1e-4)
    # The smallest distance is at most a tenth too large, and a margin beyond it is broken.
    assert violations
    exact = seen_with(free_plan, ball, margin=10.0)[0][0]
    assert exact.distance <= nearest.distance <= exact.distance / 0.9 + 1e-9


def test_a_plan_among_obstacles_passes_with_its_smallest_distance_shown() -> None:
    free = rt.CollisionFree([BOX], self_collision=False)
    ends = rt.State(q=START, v=0), rt.State(q=GOAL, v=0)
    solution = rt.plan(rt.Phase(rt.load("ur5"), (0.2, 5), *ends, rt.Duration(), constraints=[free]))
    report = rt.validate(solution)
    assert report.passed, report
    (nearest,) = report.clearances
    assert 0.0 < nearest.distance < 0.2 and "smallest distance" in str(report)


def test_a_link_that_is_always_near_the_base_need_not_keep_the_margin_from_it() -> None:
    """The upper arm of a ur5 is at most 2 cm from its base in every posture; forearm and base can keep 2 cm."""
    ur5, home = rt.load("ur5"), np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
    ends = rt.State(q=home, v=0), rt.State(q=home + [0.8, 0, 0, 0, 0, 0], v=0)
    plan = rt.plan(rt.Phase(ur5, 1.0, *ends, rt.Effort(), [rt.CollisionFree(margin=0.02)]))
    body = own_body(ur5)
    pair = next(
        k for k in range(len(body.pairs)) if {"upper_arm_link", "base_link"} == set(body.label(k).split(" and "))
    )
    assert 0.0 < body.distance(ur5, home, pair) < 0.02
    _, broken, left_out = clearance_of(plan.phases[0])
    assert not broken
    assert any("upper_arm_link" in each and "base_link" in each for each in left_out)


@pytest.mark.parametrize("margin", [0.03, 0.05])
def test_a_margin_between_links_that_spheres_do_not_resolve_is_not_claimed(margin: float) -> None:
    """A proved plan passes; the wrist of a ur5 is nearer to its forearm than the margin, and no row prevents that."""
    ur5, home = rt.load("ur5"), np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
    ends = rt.State(q=home, v=0), rt.State(q=home + [0.8, 0, 0, 0, 0, 0], v=0)
    plan = rt.plan(rt.Phase(ur5, 1.0, *ends, rt.Effort(), [rt.CollisionFree(margin=margin)]))
    report = rt.validate(plan)
    assert report.passed, report
    claim = next(each for each in report.claims if each.name == "obstacles")
    assert claim.judgement is Judgement.NOT_JUDGED
    assert "forearm_link and wrist_3_link" in claim.notes[0] or "wrist_3_link and forearm_link" in claim.notes[0]
    exempt = [each for each in report.left_out if "sampled configuration" in each]
    assert any("upper_arm_link" in each and "base_link" in each for each in exempt)
    assert not any("base_link" in each for each in claim.notes)
