"""Mirror images: the end of a gait is the image of its start, and the image of a symmetric robot is the robot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.gait.mirroring.common_limits import joint_without_common_limits
from robotraj.gait.mirroring.imbalance import imbalance
from robotraj.gait.mirroring.mirror import REFLECTION, mirror

FEET = {
    "five_link": ("left_foot", "right_foot"),
    "solo12": ("FL_FOOT", "FR_FOOT"),
    "bolt": ("FL_FOOT", "FR_FOOT"),
    "talos_legs": ("left_sole_link", "right_sole_link"),
    "hyq": ("lf_foot", "rf_foot"),
}


def mirrored(robot: rt.Robot, q: np.ndarray, repeat: rt.Mirror) -> np.ndarray:
    """Return the mirror image (nq,) of a configuration."""
    names = robot.position_names
    both = {**repeat.partners, **{b: a for a, b in repeat.partners.items()}}
    at = {name: i for i, name in enumerate(names)}
    return np.array([(-1.0 if n in repeat.negated else 1.0) * q[at[both.get(n, n)]] for n in names])


@pytest.mark.parametrize("name", FEET)
def test_feet_of_the_image_stand_at_the_image_of_the_feet(name: str) -> None:
    robot = rt.load(name, root="floating")
    repeat = mirror(robot, imbalance=1.0)
    rng = np.random.default_rng(1)
    q = np.array(robot.neutral)
    q[:3] = rng.normal(size=3)
    quaternion = rng.normal(size=4)
    q[3:7] = quaternion / np.linalg.norm(quaternion)
    q[7:] += 0.3 * rng.normal(size=len(q) - 7)
    here, there = robot.model.createData(), robot.model.createData()
    pin.framesForwardKinematics(robot.model, here, q)
    pin.framesForwardKinematics(robot.model, there, mirrored(robot, q, repeat))
    first, second = (robot.frame(foot) for foot in FEET[name])
    for a, b in ((first, second), (second, first)):
        np.testing.assert_allclose(there.oMf[b].translation, REFLECTION * here.oMf[a].translation, atol=2e-3)
    np.testing.assert_allclose(mirrored(robot, mirrored(robot, q, repeat), repeat), q, atol=1e-15)


def test_a_floating_root_negates_roll_yaw_and_sideways() -> None:
    repeat = mirror(rt.load("solo12", root="floating"))
    root = [name for name in repeat.negated if name.startswith("root_")]
    assert root == ["root_y", "root_qx", "root_qz", "root_vy", "root_wx", "root_wz"]
    assert "FL_HAA" in repeat.negated and "FL_HFE" not in repeat.negated


@pytest.mark.parametrize(("name", "negated"), [("pendulum", ()), ("two_link_arm", ("shoulder", "elbow"))])
def test_axes_across_the_plane_keep_their_sign(name: str, negated: tuple[str, ...]) -> None:
    assert mirror(rt.load(name)).negated == negated


def test_a_planar_robot_only_swaps() -> None:
    repeat = mirror(rt.load("five_link", root="planar"), {"q.root_x": 0.5})
    assert repeat.negated == ()
    assert repeat.partners["left_hip"] == "right_hip" and repeat.partners["left_foot"] == "right_foot"
    assert repeat.displacement == {"q.root_x": 0.5}


def test_an_arm_is_not_its_own_image() -> None:
    """Its lifting joints lie beside the plane, but on axes that are their own images; the wrist's does not."""
    with pytest.raises(rt.InputError, match="'wrist_2_joint'.*from its mirror image"):
        mirror(rt.load("ur5"))


@pytest.mark.parametrize("name", ["hyq", "a1", "laikago", "anymal_c"])
def test_robots_of_unequal_sides_repeat_without_a_mirror(name: str) -> None:
    robot = rt.load(name, root="floating")
    with pytest.raises(rt.InputError, match="inertia of .* is not symmetric.*repeat=rt.Periodic"):
        mirror(robot)
    with pytest.warns(UserWarning, match="both halves of the gait are planned, with rt.Periodic"):
        problem = rt.gait.trot(robot, step_length=0.1, duration=0.3)
    assert len(problem.phases) == 2
    assert isinstance(problem.links[-1].repeat, rt.Periodic)


def test_a_robot_whose_joints_have_no_mirrored_position_repeats_without_a_mirror() -> None:
    """Both shoulders of the URDF turn by 0.0087 rad or more to the same side, where a mirror wants opposite ones."""
    robot = rt.load("simple_humanoid", root="floating")
    with pytest.warns(UserWarning, match="'LARM_SHOULDER_R' .* no value in common .* 'RARM_SHOULDER_R'"):
        problem = rt.gait.walk(robot, step_length=0.1, duration=0.4, feet=["l_ankle", "r_ankle"])
    assert len(problem.phases) == 2
    free = robot.limits.with_(position=(-1.0, 1.0))
    assert joint_without_common_limits(replace(robot, limits=free), mirror(robot)) is None


@pytest.mark.parametrize("name", ["solo12", "solo8", "bolt"])
def test_robots_of_equal_sides_are_mirrored(name: str) -> None:
    robot = rt.load(name, root="floating")
    assert imbalance(robot, mirror(robot)) < 1e-3


def test_a_heavier_leg_is_an_imbalance() -> None:
    robot = rt.load("simple_humanoid", root="floating")
    model = pin.Model(robot.model)
    leg = model.getJointId("LLEG_HIP_R")
    model.inertias[leg] = pin.Inertia(
        model.inertias[leg].mass + 0.5, model.inertias[leg].lever, model.inertias[leg].inertia
    )
    heavier = replace(robot, model=model)
    assert imbalance(robot, mirror(robot)) < 1e-12
    with pytest.raises(rt.InputError, match="is not symmetric"):
        mirror(heavier)


def test_partners_that_are_no_image_are_refused_by_name() -> None:
    robot = rt.load("solo12", root="floating")
    with pytest.raises(rt.InputError, match="'FL_HFE'"):
        mirror(robot, partners={"FL_HFE": "HL_HFE"})
    with pytest.raises(rt.InputError, match="no joint or frame named 'FL_HIP'"):
        mirror(robot, partners={"FL_HIP": "FR_HIP"})
