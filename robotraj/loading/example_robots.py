"""The robots of example-robot-data 6.0.0, which ships URDFs and SRDFs without a list of their names."""

from __future__ import annotations

import sys
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from robotraj.loading.entry import Entry

SHARE = Path("cmeel.prefix/share/example-robot-data/robots")

# name: (URDF, SRDF beside its folder or "", end effector or "", what it is)
TABLE: dict[str, tuple[str, str, str, str]] = {
    "a1": ("a1_description/urdf/a1.urdf", "a1", "", "Unitree A1 quadruped"),
    "alex": ("alex_description/urdf/alex_nub_hands.urdf", "alex_nub_hands", "", "Boardwalk Alex upper body, nub hands"),
    "alexander": ("alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf", "alexander", "", "IHMC Alexander legs"),
    "allegro_left_hand": ("allegro_hand_description/urdf/allegro_left_hand.urdf", "", "", "Allegro left hand"),
    "allegro_right_hand": ("allegro_hand_description/urdf/allegro_right_hand.urdf", "", "", "Allegro right hand"),
    "anymal": ("anymal_b_simple_description/robots/anymal.urdf", "anymal", "", "ANYmal B quadruped"),
    "anymal_kinova": (
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "anymal-kinova",
        "",
        "ANYmal B with a Kinova arm",
    ),
    "anymal_c": ("anymal_c_simple_description/urdf/anymal.urdf", "anymal", "", "ANYmal C quadruped"),
    "asr_twodof": ("asr_twodof_description/urdf/TwoDofs.urdf", "", "", "ASR two-joint arm with series elasticity"),
    "b1": ("b1_description/urdf/b1.urdf", "b1", "", "Unitree B1 quadruped"),
    "b1_z1": ("b1_description/urdf/b1-z1.urdf", "b1-z1", "", "Unitree B1 quadruped with a Z1 arm"),
    "baxter": ("baxter_description/urdf/baxter.urdf", "baxter_manipulation", "", "Rethink Baxter, two arms"),
    "bolt": ("bolt_description/robots/bolt.urdf", "bolt", "", "ODRI Bolt biped"),
    "borinot": ("borinot_description/urdf/borinot_flying_arm_2.urdf", "borinot_flying_arm_2", "", "Borinot flying arm"),
    "centauro": ("centauro_description/urdf/centauro.urdf", "centauro", "", "Centauro, four legs and two arms"),
    "double_pendulum": ("double_pendulum_description/urdf/double_pendulum.urdf", "", "", "double pendulum"),
    "double_pendulum_continuous": (
        "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
        "",
        "",
        "double pendulum with continuous joints",
    ),
    "double_pendulum_simple": (
        "double_pendulum_description/urdf/double_pendulum_simple.urdf",
        "",
        "",
        "double pendulum without shapes of its frame",
    ),
    "finger_edu": ("finger_edu_description/robots/finger_edu.urdf", "finger_edu", "", "ODRI teaching finger"),
    "g1": ("g1_description/urdf/g1_29dof_rev_1_0.urdf", "", "", "Unitree G1 humanoid, 29 joints"),
    "g1_hands": ("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", "", "", "Unitree G1 humanoid with hands"),
    "go1": ("go1_description/urdf/go1.urdf", "go1", "", "Unitree Go1 quadruped"),
    "go2": ("go2_description/urdf/go2.urdf", "go2", "", "Unitree Go2 quadruped"),
    "hextilt": ("hextilt_description/urdf/hextilt_flying_arm_5.urdf", "hextilt_flying_arm_5", "", "Hextilt flying arm"),
    "human": ("human_description/robots/human.urdf", "", "", "human body model"),
    "hyq": ("hyq_description/robots/hyq_no_sensors.urdf", "hyq", "", "IIT HyQ quadruped"),
    "icub": ("icub_description/robots/icub.urdf", "icub", "", "IIT iCub humanoid"),
    "icub_reduced": ("icub_description/robots/icub_reduced.urdf", "icub", "", "IIT iCub humanoid, fewer joints"),
    "kinova": ("kinova_description/robots/kinova.urdf", "kinova", "j2s6s200_end_effector", "Kinova Jaco 2 arm"),
    "laikago": ("laikago_description/urdf/laikago.urdf", "", "", "Unitree Laikago quadruped"),
    "panda": ("panda_description/urdf/panda.urdf", "panda", "panda_hand_tcp", "Franka Panda arm with its gripper"),
    "panda_collision": (
        "panda_description/urdf/panda_collision.urdf",
        "panda",
        "panda_hand_tcp",
        "Franka Panda arm with simple collision shapes",
    ),
    "pr2": ("pr2_description/urdf/pr2.urdf", "pr2", "", "Willow Garage PR2, two arms"),
    "quadruped": ("quadruped_description/urdf/quadruped.urdf", "", "", "small quadruped with eight joints"),
    "romeo": ("romeo_description/urdf/romeo.urdf", "romeo", "", "Aldebaran Romeo humanoid"),
    "romeo_small": ("romeo_description/urdf/romeo_small.urdf", "romeo_small", "", "Aldebaran Romeo, no fingers"),
    "simple_humanoid": (
        "simple_humanoid_description/urdf/simple_humanoid.urdf",
        "simple_humanoid",
        "",
        "humanoid of simple shapes",
    ),
    "so100": ("so_arm_description/urdf/so100.urdf", "", "", "SO-ARM100 desktop arm"),
    "so101": ("so_arm_description/urdf/so101.urdf", "", "", "SO-ARM101 desktop arm"),
    "solo8": ("solo_description/robots/solo.urdf", "solo", "", "ODRI Solo quadruped, eight joints"),
    "solo12": ("solo_description/robots/solo12.urdf", "solo", "", "ODRI Solo quadruped, twelve joints"),
    "talos": ("talos_data/robots/talos_reduced.urdf", "talos", "gripper_right_base_link", "PAL Talos humanoid"),
    "talos_arm": ("talos_data/robots/talos_left_arm.urdf", "talos", "gripper_left_base_link", "PAL Talos, left arm"),
    "talos_box": ("talos_data/robots/talos_reduced_box.urdf", "talos", "", "PAL Talos with box-shaped collision feet"),
    "talos_full": ("talos_data/robots/talos_full_v2.urdf", "talos", "", "PAL Talos, all joints"),
    "talos_legs": ("talos_data/robots/talos_reduced.urdf", "talos", "", "PAL Talos, only its legs move"),
    "tiago": ("tiago_description/robots/tiago.urdf", "", "hand_tool_link", "PAL Tiago mobile manipulator with hand"),
    "tiago_dual": ("tiago_description/robots/tiago_dual.urdf", "", "", "PAL Tiago with two arms"),
    "tiago_no_hand": ("tiago_description/robots/tiago_no_hand.urdf", "", "arm_tool_link", "PAL Tiago without hand"),
    "tiago_pro": ("tiago_pro_description/robots/tiago_pro.urdf", "", "", "PAL Tiago Pro, two arms"),
    "ur3": ("ur_description/urdf/ur3_robot.urdf", "", "tool0", "Universal Robots UR3 arm"),
    "ur3_gripper": ("ur_description/urdf/ur3_gripper.urdf", "ur3_gripper", "tool0", "UR3 arm with a gripper"),
    "ur3_limited": ("ur_description/urdf/ur3_joint_limited_robot.urdf", "", "tool0", "UR3 arm, joints within +-pi"),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "", "tool0", "Universal Robots UR5 arm"),
    "ur5_gripper": ("ur_description/urdf/ur5_gripper.urdf", "ur5_gripper", "tool0", "UR5 arm with a gripper"),
    "ur5_limited": ("ur_description/urdf/ur5_joint_limited_robot.urdf", "", "tool0", "UR5 arm, joints within +-pi"),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", "", "tool0", "Universal Robots UR10 arm"),
    "ur10_limited": ("ur_description/urdf/ur10_joint_limited_robot.urdf", "", "tool0", "UR10 arm, joints within +-pi"),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", "xarm7", "", "UFACTORY xArm 7 arm"),
    "z1": ("z1_description/urdf/z1.urdf", "z1", "", "Unitree Z1 arm"),
}

MOVING = {"talos_legs": ("leg_",)}
"""Robots of which only some joints move: beginnings of their names."""


def folder() -> Path | None:
    """Folder of the package's robots, or None when example-robot-data is not installed."""
    try:
        listed = files("example-robot-data") or []
    except PackageNotFoundError:
        return None
    for file in listed:
        if file.match("package.xml") and file.parent.name == "example-robot-data":
            return Path(str(file.locate())).resolve().parent / "robots"
    nearby = (Path(entry) / SHARE for entry in sys.path)
    return next((path for path in nearby if path.is_dir()), None)


@lru_cache(maxsize=1)
def example_robots() -> dict[str, Entry]:
    """Give the catalogue's entries whose URDF is there."""
    robots = folder()
    if robots is None:
        return {}
    entries = {}
    for name, (urdf, srdf, end_effector, description) in TABLE.items():
        path = robots / urdf
        beside = robots / urdf.split("/")[0] / "srdf" / f"{srdf}.srdf"
        if path.is_file():
            entries[name] = Entry(
                name,
                description,
                "example-robot-data",
                path,
                beside if srdf else None,
                moving=MOVING.get(name, ()),
                end_effector=end_effector or None,
                licence=f"see example-robot-data, robots/{urdf.split('/')[0]}",
                provenance="example-robot-data 6.0.0",
            )
    return entries
