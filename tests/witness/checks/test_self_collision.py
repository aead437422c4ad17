"""Links that overlap fail a plan, whatever its problem states; what cannot be judged is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.kinematics import Kinematics
from robotraj.solution.claims.claim import Judgement
from robotraj.witness.checks.self_collision import SWITCHED_OFF, own_body_of

FREE, FOLDED = rt.State(q=(0, -1.5, 0.5, -1.2, 0, 0), v=0), rt.State(q=(0, -1.5, 2.8, 1.1, 1.3, 0), v=0)


def folded(**changes: object) -> rt.Solution:
    phase = rt.Phase(rt.load("ur5"), 1.0, FREE, FOLDED, rt.Effort(), name="fold")
    return rt.plan(phase.with_(**changes), mesh=rt.Mesh(8))


def test_a_plan_through_the_robot_itself_fails_and_names_links_depth_and_time() -> None:
    report = rt.validate(folded())
    assert not report.passed
    worst = report.self_collisions[0]
    assert worst.distance < -1e-3 and worst.phase == "fold" and 0.0 <= worst.time <= 1.0
    assert "wrist" in worst.label and f"overlap: {worst.label}" in str(report)
    (sentence,) = (each for each in report.failures(report.tolerances) if "overlap" in each)
    assert f"{-worst.distance:.3g} m" in sentence and "'fold'" in sentence


def test_a_collision_free_that_spheres_do_not_resolve_claims_nothing() -> None:
    """The spheres around forearm and wrist overlap so often that the constraint leaves this pair out."""
    free = rt.CollisionFree()
    arm = rt.load("ur5")
    kept = {frozenset(free.pairs(arm).names(pair)) for pair in range(len(free.pairs(arm)))}
    # The wrist turns through the forearm between two configurations without an overlap.
    before, after = (rt.State(q=(0, -1.5, 0.5, wrist, 0, 0), v=0) for wrist in (0.6, 2.4))
    (part,) = rt.plan(rt.Phase(arm, 1.0, before, after, rt.Effort(), [free]), mesh=rt.Mesh(8)).phases
    overlaps = {frozenset(each.label.split(" and ")) for each in own_body_of(part).overlaps}
    assert frozenset(("wrist_2_link", "forearm_link")) in overlaps - kept


def test_self_collision_false_is_named_and_not_judged() -> None:
    report = rt.validate(folded(self_collision=False))
    assert report.passed and not report.self_collisions
    assert report.left_out == (f"all links in phase 'fold': {SWITCHED_OFF}",) and SWITCHED_OFF in str(report)


def test_the_nearest_links_of_a_free_plan_are_a_figure() -> None:
    solution = rt.plan(rt.Phase(rt.load("ur5"), 1.0, FREE, rt.State(q=(1, -1, 0.5, -1.2, 0, 0), v=0), rt.Effort()))
    (figures,) = (own_body_of(part) for part in solution.phases)
    assert not figures.overlaps and figures.judged > 10 and figures.unjudged == ()
    assert figures.nearest is not None and 0.0 < figures.nearest.distance < 0.05
    assert "own links: nearest are" in str(rt.validate(solution))


def with_visual_shapes_alone(folder: Path) -> rt.Robot:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    ball = '<geometry><sphere radius="0.05"/></geometry>'
    links = f'<link name="base"><collision>{ball}</collision></link>'
    links += f'<link name="arm">{inertial}<visual>{ball}</visual></link>'
    joint = '<parent link="base"/><child link="arm"/><limit lower="-2" upper="2" velocity="5" effort="50"/>'
    text = f'<robot name="r">{links}<joint name="a" type="revolute">{joint}<axis xyz="0 1 0"/></joint></robot>'
    (folder / "r.urdf").write_text(text)
    return rt.load(str(folder / "r.urdf"))


def test_a_link_with_visual_shapes_alone_is_named_in_the_report(tmp_path: Path) -> None:
    arm = with_visual_shapes_alone(tmp_path)
    solution = rt.plan(rt.Phase(arm, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort()), mesh=rt.Mesh(6))
    report = rt.validate(solution)
    assert report.unguarded == ("arm: it has <visual> shapes only",) and "not judged: arm" in str(report)


def test_distances_are_not_claimed_where_a_link_has_visual_shapes_alone(tmp_path: Path) -> None:
    """The arm passes the ball at a distance of its invisible shape, which nobody knows."""
    arm = with_visual_shapes_alone(tmp_path)
    ball = rt.obstacles.Sphere(0.05, (0.0, 1.0, 0.0), name="ball")
    ends = rt.State(q=0, v=0), rt.State(q=1, v=0)
    solution = rt.plan(rt.Phase(arm, 1.0, *ends, rt.Effort(), constraints=[rt.CollisionFree([ball])]))
    for claims in (solution.claims, rt.validate(solution).claims):
        (claim,) = (each for each in claims if each.name == "obstacles")
        assert claim.judgement is Judgement.NOT_JUDGED and "arm: it has <visual> shapes only" in claim.notes[0]


def test_the_legs_of_a_floating_robot_are_judged() -> None:
    """Both legs of bolt turned inwards meet; the plan moves them there and back by kinematics."""
    bolt = rt.load("bolt", root="floating")
    crossed = bolt.neutral.copy()
    names = list(bolt.position_names)
    for joint, angle in (("FL_HAA", -0.5), ("FR_HAA", 0.5)):
        crossed[next(k for k, name in enumerate(names) if joint in name)] = angle
    ends = rt.State(q=bolt.neutral, v=0), rt.State(q=crossed, v=0)
    phase = rt.Phase(bolt, 0.4, *ends, limits=None, dynamics=Kinematics())
    solution = rt.plan(phase, mesh=rt.Mesh(6), check=False)
    (figures,) = (own_body_of(part) for part in solution.phases)
    assert any("FL" in each.label and "FR" in each.label for each in figures.overlaps)
    assert np.all([each.distance <= 0.0 for each in figures.overlaps])


@pytest.mark.slow
def test_a_robot_of_two_arms_is_judged_across_them() -> None:
    two = rt.robot.join({"left": rt.load("ur5"), "right": rt.load("ur5")}, at={"right": (0.4, 0.0, 0.0)})
    solution = rt.plan(rt.Phase(two, 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort()), mesh=rt.Mesh(4))
    (figures,) = (own_body_of(part) for part in solution.phases)
    assert figures.judged > 2 * 21
