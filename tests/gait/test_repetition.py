"""Robots that are not their own mirror images plan both halves; robots that face sideways are named."""

from __future__ import annotations

import re

import numpy as np
import pytest

import robotraj as rt
from robotraj.gait.repetition import _symmetric_repeat

LINK = (
    '<link name="{0}"><inertial><mass value="{1}"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/><axis xyz="{4}"/>'
    '<limit lower="{5}" upper="{6}" velocity="10" effort="30"/></joint>'
)


FEET = {"fl_foot": "fr_foot", "fr_foot": "fl_foot", "rl_foot": "rr_foot", "rr_foot": "rl_foot"}


def quadruped(folder, wider=0.0, rpy="0 0 0", base=None, hands=False, folded=False):
    """Return a robot of four bent legs; the left front hip stands further out, and the trunk is turned in the root.

    The zero of folded legs is a shank along the thigh, whose end is at the hip.

    Hands are two fingers on each side, of which one follows the other; their names come before those of the legs.
    """
    parts = [
        '<link name="base"/><joint name="mount" type="fixed"><parent link="base"/><child link="trunk"/>'
        f'<origin rpy="{rpy}"/></joint>',
        LINK.format("trunk", 8),
    ]
    swing, knee, tip = ((-1.6, 1.6), (0.3, 2.9), 0.25) if folded else ((0.3, 2), (-2.4, -0.6), -0.25)
    for leg, x, y in (("fl", 0.2, 0.1 + wider), ("fr", 0.2, -0.1), ("rl", -0.2, 0.1), ("rr", -0.2, -0.1)):
        parts += [LINK.format(f"{leg}_{part}", 0.4) for part in ("hip", "thigh", "shank")]
        parts += [
            JOINT.format(f"{leg}_ab", "trunk", f"{leg}_hip", f"{x} {y} 0", "1 0 0", -1, 1),
            JOINT.format(f"{leg}_swing", f"{leg}_hip", f"{leg}_thigh", "0 0 0", "0 1 0", *swing),
            JOINT.format(f"{leg}_knee", f"{leg}_thigh", f"{leg}_shank", "0 0 -0.25", "0 1 0", *knee),
            f'<link name="{leg}_foot"/><joint name="{leg}_tip" type="fixed"><parent link="{leg}_shank"/>'
            f'<child link="{leg}_foot"/><origin xyz="0 0 {tip}"/></joint>',
        ]
    for side, y in (("l", 0.05), ("r", -0.05)) if hands else ():
        first, second = f"arm_{side}_finger", f"arm_{side}_thumb"
        follows = JOINT.format(f"{second}_joint", "trunk", second, f"0.3 {y} 0", "0 0 1", -1, 1)
        parts += [LINK.format(name, 0.05) for name in (first, second)]
        parts += [
            JOINT.format(f"{first}_joint", "trunk", first, f"0.3 {y} 0", "0 1 0", -1, 1),
            follows.replace("</joint>", f'<mimic joint="{first}_joint" multiplier="{np.sign(y) * 2}"/></joint>'),
        ]
    path = folder / "quadruped.urdf"
    path.write_text(f'<robot name="quadruped">{"".join(parts)}</robot>')
    return rt.load(path, root="floating", base=base)


def test_a_robot_that_is_its_own_mirror_image_plans_one_half(tmp_path):
    assert isinstance(_symmetric_repeat(quadruped(tmp_path), FEET), rt.Mirror)


def test_hands_whose_fingers_follow_each_other_leave_a_robot_its_own_mirror_image(tmp_path):
    robot = quadruped(tmp_path, hands=True)
    assert len(robot.followers) == 2
    assert isinstance(_symmetric_repeat(robot, FEET), rt.Mirror)


def test_a_robot_with_one_wider_hip_plans_both_halves_and_trots(tmp_path):
    robot = quadruped(tmp_path, wider=0.02)
    with pytest.warns(UserWarning, match="'fl_ab'.*0.02 m from its mirror image.*both halves"):
        gait = rt.gait.trot(robot, step_length=0.06, duration=0.25, clearance=0.03)
    assert any(isinstance(getattr(link, "repeat", link), rt.Periodic) for link in gait.links)
    assert rt.plan(gait, time_limit=60).proof.holds


def test_legs_that_are_folded_at_zero_stand_and_trot(tmp_path):
    robot = quadruped(tmp_path, folded=True)
    assert 0.2 < rt.gait.stand(robot)[2] < 0.5
    gait = rt.gait.trot(robot, step_length=0.06, duration=0.25, clearance=0.03)
    assert rt.plan(gait, time_limit=60).proof.holds


@pytest.mark.parametrize(
    ("rpy", "words"),
    [
        ("0 0 1.5707963267948966", "faces along y: 8 joints of its legs turn about x and 4 about y"),
        ("-1.5707963267948966 0 0", "legs .* point against its y axis"),
        ("0 1.5707963267948966 0", "legs .* point against its x axis"),
        ("3.141592653589793 0 0", "legs .* point against its -z axis"),
    ],
)
def test_the_call_of_the_refusal_turns_a_robot_of_other_axes_to_walk_along_x(tmp_path, rpy, words):
    with pytest.raises(rt.InputError, match=words) as refused:
        rt.gait.trot(quadruped(tmp_path, rpy=rpy), step_length=0.06, duration=0.25)
    numbers = re.search(r"base=\(\(0, 0, 0\), \((.*?)\)\)", str(refused.value)).group(1)
    base = ((0.0, 0.0, 0.0), tuple(float(each) for each in numbers.split(",")))
    turned, plain = quadruped(tmp_path, rpy=rpy, base=base), quadruped(tmp_path)
    efforts = []
    for robot in (turned, plain):
        gait = rt.gait.trot(robot, step_length=0.06, duration=0.25, clearance=0.03)
        assert isinstance(gait.links[-1].repeat, rt.Mirror)
        efforts.append(rt.plan(gait, mesh=rt.Mesh(6)).objective)
    assert efforts[0] == pytest.approx(efforts[1], rel=1e-5)
