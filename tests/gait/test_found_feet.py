"""Feet, their sides and mirror images are found by places where names do not show them."""

from __future__ import annotations

import warnings
from xml.etree import ElementTree

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.sides.images import frames_across

INERTIAL = (
    '<inertial><origin xyz="0 {1} -0.1"/><mass value="{0}"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LIMIT = '<limit lower="{}" upper="{}" velocity="20" effort="60"/>'
JOINT = '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><origin xyz="{}"/><axis xyz="{}"/>{}</joint>'
HIP, KNEE = LIMIT.format(0.3, 2), LIMIT.format(-2.4, -0.6)
LEGS = {"fl": (0.2, 0.1), "fr": (0.2, -0.1), "rl": (-0.2, 0.1), "rr": (-0.2, -0.1)}
NAMES = {
    "usual": ("FL_foot", "FR_foot", "RL_foot", "RR_foot"),
    "glued": ("toeFL", "toeFR", "toeRL", "toeRR"),
    "numbers before": ("01_lf_foot", "02_rf_foot", "03_lh_foot", "04_rh_foot"),
    "numbers after": ("toe0", "toe1", "toe2", "toe3"),
    "no word": ("fl_ankle", "fr_ankle", "rl_ankle", "rr_ankle"),
    "nothing": ("a", "b", "c", "d"),
}


def dog(folder, names, head=0.0):
    """Four legs with abduction, hip and knee, and a head that nods about its own y axis at y = head."""
    parts = [f'<link name="trunk">{INERTIAL.format(8, 0)}</link>']
    for (leg, (x, y)), foot in zip(LEGS.items(), names, strict=True):
        parts += [f'<link name="{each}_{leg}">{INERTIAL.format(0.5, 0)}</link>' for each in ("hip", "thigh", "shank")]
        parts += [
            f'<link name="{foot}"/>',
            JOINT.format(f"{leg}_ab", "revolute", "trunk", f"hip_{leg}", f"{x} {y} 0", "1 0 0", LIMIT.format(-1, 1)),
            JOINT.format(
                f"{leg}_hip", "revolute", f"hip_{leg}", f"thigh_{leg}", "0 0 0", "0 1 0", LIMIT.format(0.3, 2)
            ),
            JOINT.format(f"{leg}_knee", "revolute", f"thigh_{leg}", f"shank_{leg}", "0 0 -0.25", "0 1 0", KNEE),
            JOINT.format(f"{leg}_tip", "fixed", f"shank_{leg}", foot, "0 0 -0.25", "0 1 0", ""),
        ]
    parts += [
        f'<link name="head">{INERTIAL.format(0.3, -head)}</link>',
        JOINT.format("nod", "revolute", "trunk", "head", f"0.3 {head} 0.1", "0 1 0", LIMIT.format(-2, 2)),
    ]
    path = folder / "dog.urdf"
    path.write_text(f'<robot name="dog">{"".join(parts)}</robot>', encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return rt.load(path, root="floating")


@pytest.mark.parametrize("kind", NAMES)
def test_feet_are_found_and_trot_whatever_their_names(tmp_path, kind):
    robot = dog(tmp_path, NAMES[kind])
    assert sorted(rt.gait.feet_of(robot, None)) == sorted(NAMES[kind])
    problem = rt.gait.trot(robot, step_length=0.06, duration=0.25, clearance=0.03)
    standing = {contact.frame for contact in problem.phases[0].contacts}
    first, second, third, fourth = NAMES[kind]
    assert standing in ({first, fourth}, {second, third})


@pytest.mark.parametrize("kind", NAMES)
def test_frames_have_partners_on_the_other_side(tmp_path, kind):
    names = NAMES[kind]
    across = frames_across(dog(tmp_path, names), names)
    assert across == dict(zip(names, (names[1], names[0], names[3], names[2]), strict=True))


def test_a_joint_may_lie_anywhere_on_its_axis(tmp_path):
    mirror = rt.gait.mirror(dog(tmp_path, NAMES["usual"], head=0.03))
    assert "nod" not in mirror.partner_of
    assert "nod" not in mirror.negated


def test_an_arm_has_no_feet():
    with pytest.raises(rt.InputError, match="named like a foot"):
        rt.gait.feet_of(rt.load("ur5", root="floating"), None)


@pytest.mark.parametrize(
    ("name", "feet"),
    [("g1", {"left_ankle_roll_link", "right_ankle_roll_link"}), ("simple_humanoid", {"l_ankle", "r_ankle"})],
)
def test_feet_of_robots_without_the_word(name, feet):
    robot = rt.load(name, root="floating")
    assert set(rt.gait.feet_of(robot, None)) == feet
    assert np.isfinite(rt.gait.stand(robot)).all()


def test_legs_without_frames_at_their_ends_are_named(tmp_path):
    dog(tmp_path, NAMES["nothing"])
    tree = ElementTree.parse(tmp_path / "dog.urdf")
    root = tree.getroot()
    for each in [*root]:
        if each.get("name") in (*NAMES["nothing"], *(f"{leg}_tip" for leg in LEGS)):
            root.remove(each)
    ball = '<collision><origin xyz="0 0 -0.25"/><geometry><sphere radius="0.02"/></geometry></collision>'
    for leg in LEGS:
        root.find(f"link[@name='shank_{leg}']").append(ElementTree.fromstring(ball))
    tree.write(tmp_path / "dog.urdf")
    robot = rt.load(tmp_path / "dog.urdf", root="floating")
    with pytest.raises(rt.InputError, match="no frames at their ends: those of links 'shank_fl', .* fixed joint"):
        rt.gait.feet_of(robot, None)
    shanks = [f"shank_{leg}" for leg in LEGS]
    assert rt.gait.feet_of(robot, shanks) == tuple(shanks)


def test_the_frame_of_a_last_joint_is_no_foot_where_the_leg_goes_on(tmp_path):
    """A shank that is folded up ends above its knee, whose frame is then the lowest one of the leg."""
    dog(tmp_path, NAMES["nothing"])
    text = (tmp_path / "dog.urdf").read_text(encoding="utf-8")
    folded = text.replace(KNEE, LIMIT.format(0.3, 2.8))
    for foot in NAMES["nothing"]:
        tip = f'<child link="{foot}"/><origin xyz="0 0 -0.25"/>'
        assert tip in folded
        folded = folded.replace(tip, tip.replace("-0.25", "0.25"))
    (tmp_path / "dog.urdf").write_text(folded, encoding="utf-8")
    robot = rt.load(tmp_path / "dog.urdf", root="floating")
    assert sorted(rt.gait.feet_of(robot, None)) == sorted(NAMES["nothing"])


def test_sites_of_mjcf_at_the_ends_of_legs_are_feet(tmp_path):
    inertial = '<inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.01 0.01 0.01"/>'
    legs = "".join(
        f'<body name="thigh_{leg}" pos="{x} {y} 0"><joint name="{leg}_hip" axis="0 1 0" range="-1 2"/>{inertial}'
        f'<body name="shank_{leg}" pos="0 0 -0.2"><joint name="{leg}_knee" axis="0 1 0" range="-2.4 -0.2"/>{inertial}'
        f'<geom type="sphere" size="0.02" pos="0 0 -0.2"/><site name="{leg}_tip" pos="0 0 -0.2"/></body></body>'
        for leg, (x, y) in LEGS.items()
    )
    (tmp_path / "dog.xml").write_text(
        '<mujoco model="dog"><compiler angle="radian" autolimits="true"/><worldbody><body name="trunk"><freejoint/>'
        f'<inertial pos="0 0 0" mass="8" diaginertia="0.1 0.1 0.1"/>{legs}</body></worldbody></mujoco>',
        encoding="utf-8",
    )
    robot = rt.load(tmp_path / "dog.xml", root="floating")
    assert sorted(rt.gait.feet_of(robot, None)) == sorted(f"{leg}_tip" for leg in LEGS)


def test_legs_that_lie_level_at_zero_stand_and_walk(tmp_path):
    """Six legs stick out flat in the file, as those of hexapods do; the knees bend downwards only."""
    parts = [f'<link name="trunk">{INERTIAL.format(2, 0)}</link>']
    for k in range(6):
        angle = np.pi * (k + 0.5) / 3
        leg, along, across = (
            f"leg{k}",
            np.array([np.cos(angle), np.sin(angle)]),
            np.array([-np.sin(angle), np.cos(angle)]),
        )

        def place(distance, along=along):
            return f"{distance * along[0]:.6f} {distance * along[1]:.6f} 0"

        turn, limit = f"{across[0]:.9f} {across[1]:.9f} 0", LIMIT.format(-1.6, 1.6)
        parts += [f'<link name="{leg}_{part}">{INERTIAL.format(0.1, 0)}</link>' for part in ("coxa", "femur", "tibia")]
        parts += [
            f'<link name="{leg}_tip"/>',
            JOINT.format(f"{leg}_a", "revolute", "trunk", f"{leg}_coxa", place(0.1), "0 0 1", LIMIT.format(-0.8, 0.8)),
            JOINT.format(f"{leg}_b", "revolute", f"{leg}_coxa", f"{leg}_femur", place(0.05), turn, limit),
            JOINT.format(
                f"{leg}_c", "revolute", f"{leg}_femur", f"{leg}_tibia", place(0.08), turn, LIMIT.format(0, 2.6)
            ),
            JOINT.format(f"{leg}_d", "fixed", f"{leg}_tibia", f"{leg}_tip", place(0.13), "0 0 1", ""),
        ]
    (tmp_path / "hexapod.urdf").write_text(f'<robot name="hexapod">{"".join(parts)}</robot>', encoding="utf-8")
    robot = rt.load(tmp_path / "hexapod.urdf", root="floating")
    assert rt.gait.feet_of(robot, None) == tuple(f"leg{k}_tip" for k in range(6))
    assert 0.08 < rt.gait.stand(robot)[2] < 0.2
    assert rt.plan(rt.gait.walk(robot, step_length=0.03, speed=0.1), time_limit=60).proof.holds
