"""Which pairs of shapes of a robot are judged, which are not and why, and how fast they approach each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.collision.along_motion import deepest_overlap, least_distance, near_pairs
from robotraj.robot.collision.own_body import CONSTRUCTED, DISABLED, OwnBody, own_body
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.solids import distance, touch
from robotraj.robot.collision.unguarded import SEEN_ONLY, UNREAD

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'


def link(name: str, shape: str, kind: str = "collision", at: str = "0 0 0") -> str:
    body = f'<{kind}><origin xyz="{at}"/><geometry>{shape}</geometry></{kind}>' if shape else ""
    return f'<link name="{name}">{INERTIAL}{body}</link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", at: str = "0 0 0.5") -> str:
    limit = '<limit lower="-2" upper="2" velocity="2" effort="50"/>'
    links = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{at}"/>'
    return f'<joint name="{name}" type="{kind}">{links}<axis xyz="0 1 0"/>{limit}</joint>'


def robot(tmp_path: Path, *parts: str) -> rt.Robot:
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{"".join(parts)}</robot>')
    return rt.load(str(path))


def judged(body: OwnBody) -> set[frozenset[str]]:
    return {frozenset(body.links[shape] for shape in pair) for pair in body.pairs.tolist()}


def test_a_shape_that_was_not_read_and_one_that_is_only_seen_are_named(tmp_path: Path) -> None:
    ball, mesh = '<sphere radius="0.05"/>', '<mesh filename="gone.stl"/>'
    parts = [link("base", ball), link("arm", ball), link("tool", mesh), link("camera", ball, "visual"), link("dot", "")]
    chain = [joint("a", "base", "arm"), joint("b", "arm", "tool"), joint("c", "tool", "camera", "fixed")]
    with pytest.warns(UserWarning, match=r"1 of 1 mesh files are not read"):
        made = robot(tmp_path, *parts, *chain, joint("d", "tool", "dot", "fixed"))
    body = own_body(made)
    assert body.unguarded == (("tool", UNREAD), ("camera", SEEN_ONLY))


def test_a_robot_without_collision_shapes_has_nothing_to_judge(tmp_path: Path) -> None:
    ball = '<sphere radius="0.05"/>'
    body = own_body(robot(tmp_path, link("base", ""), link("arm", ball, "visual"), joint("a", "base", "arm")))
    assert body.unguarded == () and not len(body.pairs)


def test_neighbours_are_not_judged_and_pairs_that_always_overlap_are_named(tmp_path: Path) -> None:
    """The arm's ball is so large that it overlaps the hand's in every configuration, two joints away."""
    parts = [link("base", '<sphere radius="0.05"/>'), link("arm", '<sphere radius="0.05"/>', at="0 0 0.25")]
    parts += [link("wrist", '<sphere radius="0.05"/>'), link("hand", '<sphere radius="0.8"/>', at="0 0 0.1")]
    chain = [joint("a", "base", "arm"), joint("b", "arm", "wrist"), joint("c", "wrist", "hand", at="0 0 0.1")]
    body = own_body(robot(tmp_path, *parts, *chain))
    assert body.left_out == (("arm and hand", CONSTRUCTED),)
    assert judged(body) == {frozenset(("base", "wrist")), frozenset(("base", "hand"))}


def test_an_overlap_in_the_neutral_configuration_alone_is_judged(tmp_path: Path) -> None:
    """An arm of two links that lies folded on its base at zero, and nowhere else, overlaps there by its design."""
    parts = [link("base", '<box size="0.1 0.1 0.1"/>'), link("arm", '<sphere radius="0.05"/>', at="0 0 0.25")]
    parts += [link("hand", '<sphere radius="0.02"/>')]
    chain = [joint("a", "base", "arm"), joint("b", "arm", "hand", at="0 0 -0.5")]
    body = own_body(robot(tmp_path, *parts, *chain))
    assert body.left_out == () and judged(body) == {frozenset(("base", "hand"))}


def test_pairs_of_an_srdf_are_named() -> None:
    ur5 = rt.load("ur5")
    body = own_body(ur5, (("forearm_link", "wrist_2_link"),))
    assert body.left_out == (("forearm_link and wrist_2_link", DISABLED),)
    assert judged(own_body(ur5)) - judged(body) == {frozenset(("forearm_link", "wrist_2_link"))}


def test_shapes_that_overlap_in_the_posture_of_a_legged_robot_are_left_out() -> None:
    talos = rt.load("talos_legs", root="floating")
    body = own_body(talos)
    assert ("leg_left_1_link and leg_left_3_link", CONSTRUCTED) in body.left_out
    assert not body.touching(talos, talos.neutral)
    # The legs themselves are judged.
    assert frozenset(("leg_left_6_link", "leg_right_6_link")) in judged(body)


def test_a_robot_with_a_free_root_stands_in_its_neutral_configuration() -> None:
    """The lower legs and an arm of icub_reduced are inside each other there, though seldom elsewhere."""
    made = rt.load("icub_reduced", root="floating")
    body = own_body(made)
    assert not body.touching(made, made.neutral)
    assert ("l_lower_leg and r_lower_leg", CONSTRUCTED) in body.left_out
    assert own_body(rt.load("icub_reduced")).touching(rt.load("icub_reduced"), made.neutral[7:])


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_a_distance_changes_no_faster_than_its_bound(name: str) -> None:
    arm, rng, step = rt.load(name), np.random.default_rng(3), 1e-3
    body = own_body(arm)
    lower, upper = np.maximum(arm.limits.position_lower, -3), np.minimum(arm.limits.position_upper, 3)
    for _ in range(4):
        q, v = rng.uniform(lower, upper), rng.uniform(-1, 1, arm.nv)
        places = placements(arm, np.array([q - step * v, q + step * v]))
        for pair in rng.choice(len(body.pairs), 10):
            a, b = body.pairs[pair].tolist()
            before, after = (
                distance(body.placed(a, turned, moved), body.placed(b, turned, moved))
                for turned, moved in zip(*places, strict=True)
            )
            assert abs(after - before) <= 2 * step * body.factors[pair] @ np.abs(v) + 1e-9


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_overlaps_along_a_motion_are_those_of_every_millisecond(name: str) -> None:
    arm, rng = rt.load(name), np.random.default_rng(1)
    body = own_body(arm)
    lower, upper = np.maximum(arm.limits.position_lower, -3), np.minimum(arm.limits.position_upper, 3)
    seen = 0
    for _ in range(4):
        first, last = rng.uniform(lower, upper), rng.uniform(lower, upper)
        knots, speeds = np.linspace(0.0, 0.5, 9), np.tile(np.abs(last - first) / 0.5, (8, 1))

        def motion(times, first=first, last=last):
            return first + (last - first) * np.asarray(times)[:, None] / 0.5

        found = near_pairs(arm, body, motion, knots, speeds)
        overlaps = {each.pair for each in found if each.overlaps}
        dense = set()
        for turned, moved in zip(*placements(arm, motion(np.linspace(0, 0.5, 501))), strict=True):
            placed = [body.placed(shape, turned, moved) for shape in range(len(body.solids))]
            dense |= {k for k, (a, b) in enumerate(body.pairs.tolist()) if touch(placed[a], placed[b])}
        assert dense <= overlaps
        seen += len(dense)
        for each in found:
            if each.overlaps:
                depth, time = deepest_overlap(arm, body, motion, each)
                assert 0.0 <= depth < 0.2 and time in each.times
            else:
                assert least_distance(arm, body, motion, each)[0] > 0.0
    assert seen


def test_a_link_that_stays_inside_another_one_overlaps_it(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((0.6, 0.6, 0.6)).export(tmp_path / "hull.stl")
    parts = [link("base", '<mesh filename="hull.stl"/>'), link("arm", ""), link("hand", '<sphere radius="0.05"/>')]
    made = robot(tmp_path, *parts, joint("a", "base", "arm", at="0 0 0"), joint("b", "arm", "hand", at="0 0 0.1"))
    body = own_body(made)

    def motion(times):
        return np.column_stack([np.zeros(len(times)), times])

    (found,) = near_pairs(made, body, motion, np.array([0.0, 1.0]), np.array([[0.0, 1.0]]))
    # The deepest point of the ball lies 0.3 - 0.1 + 0.05 m below the surface.
    assert found.overlaps and body.label(found.pair) == "hand and base"
    assert deepest_overlap(made, body, motion, found)[0] == pytest.approx(0.25, abs=0.01)


def test_one_ball_around_a_shape_holds_the_balls_of_the_shape(tmp_path: Path) -> None:
    box, ball = '<box size="0.5 0.1 0.1"/>', '<sphere radius="0.05"/>'
    parts = [link("base", box), link("arm", ball, at="0.1 0 0.2"), joint("a", "base", "arm")]
    body = own_body(robot(tmp_path, *parts))
    (shape, centres, radii), (outer, reach) = body.balls, body.outer_balls
    assert np.all(np.linalg.norm(centres - outer[shape], axis=1) + radii <= reach[shape])
    # A row of five balls of half the diagonal of a cube of 0.1 m, and a ball around the box of a sphere.
    assert reach[body.links.index("base")] == pytest.approx(0.2 + 0.05 * np.sqrt(3.0))
    assert reach[body.links.index("arm")] == pytest.approx(0.05 * np.sqrt(3.0))
