"""Robots that are not their own mirror images plan both halves; robots that face sideways are named."""

from __future__ import annotations

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


def quadruped(folder, wider=0.0, rpy="0 0 0"):
    """Return a robot of four bent legs; the left front hip stands further out, and the trunk is turned in the root."""
    parts = [
        '<link name="base"/><joint name="mount" type="fixed"><parent link="base"/><child link="trunk"/>'
        f'<origin rpy="{rpy}"/></joint>',
        LINK.format("trunk", 8),
    ]
    for leg, x, y in (("fl", 0.2, 0.1 + wider), ("fr", 0.2, -0.1), ("rl", -0.2, 0.1), ("rr", -0.2, -0.1)):
        parts += [LINK.format(f"{leg}_{part}", 0.4) for part in ("hip", "thigh", "shank")]
        parts += [
            JOINT.format(f"{leg}_ab", "trunk", f"{leg}_hip", f"{x} {y} 0", "1 0 0", -1, 1),
            JOINT.format(f"{leg}_swing", f"{leg}_hip", f"{leg}_thigh", "0 0 0", "0 1 0", 0.3, 2),
            JOINT.format(f"{leg}_knee", f"{leg}_thigh", f"{leg}_shank", "0 0 -0.25", "0 1 0", -2.4, -0.6),
            f'<link name="{leg}_foot"/><joint name="{leg}_tip" type="fixed"><parent link="{leg}_shank"/>'
            f'<child link="{leg}_foot"/><origin xyz="0 0 -0.25"/></joint>',
        ]
    path = folder / "quadruped.urdf"
    path.write_text(f'<robot name="quadruped">{"".join(parts)}</robot>')
    return rt.load(path, root="floating")


def test_a_robot_that_is_its_own_mirror_image_plans_one_half(tmp_path):
    assert isinstance(_symmetric_repeat(quadruped(tmp_path)), rt.Mirror)


def test_a_robot_with_one_wider_hip_plans_both_halves_and_trots(tmp_path):
    robot = quadruped(tmp_path, wider=0.02)
    with pytest.warns(UserWarning, match="'fl_ab'.*0.02 m from its mirror image.*both halves"):
        gait = rt.gait.trot(robot, step_length=0.06, duration=0.25, clearance=0.03)
    assert any(isinstance(getattr(link, "repeat", link), rt.Periodic) for link in gait.links)
    assert rt.plan(gait, time_limit=60).proof.holds


def test_a_robot_that_faces_sideways_is_named_with_the_remedy(tmp_path):
    with pytest.raises(rt.InputError, match="faces along y: .*a fixed joint to the old one"):
        rt.gait.trot(quadruped(tmp_path, rpy="0 0 1.5707963267948966"), step_length=0.06, duration=0.25)
