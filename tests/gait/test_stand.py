"""Standing: feet on the ground, knees bent, the centre of mass over the feet."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj import gait
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.guess.legs.stance import BalancedStance

ROBOTS = [
    ("five_link", "planar", PointContact),
    ("solo12", "floating", PointContact),
    ("bolt", "floating", PointContact),
    ("talos_legs", "floating", partial(FlatFoot, length=0.2, width=0.12)),
]


@pytest.mark.parametrize(("name", "root", "contact"), ROBOTS)
def test_feet_stand_on_the_ground_below_the_centre_of_mass(name: str, root: str, contact) -> None:
    robot = rt.load(name, root=root)
    q = gait.stand(robot, contact=contact)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    feet = np.array([data.oMf[robot.frame(foot)].translation for foot in gait.feet_of(robot, None)])
    np.testing.assert_allclose(feet[:, 2], 0.0, atol=1e-8)
    com = pin.centerOfMass(robot.model, data, q)
    np.testing.assert_allclose(
        com[:2], [feet[:, 0].mean(), com[1] if root == "planar" else feet[:, 1].mean()], atol=5e-3
    )
    joints = robot.limits.position_lower > -np.inf
    values = q[len(q) - joints.sum() :]
    assert np.all(values >= robot.limits.position_lower[joints] - 1e-12)
    assert np.all(values <= robot.limits.position_upper[joints] + 1e-12)


def test_straight_legs_bend() -> None:
    robot = rt.load("five_link", root="planar")
    q = gait.stand(robot)
    knee = q[robot.joint("left_knee")]
    assert 0.3 < knee < 1.2
    assert q[robot.joint("right_knee")] == pytest.approx(knee, abs=1e-6)


def test_soles_lie_flat() -> None:
    robot = rt.load("talos_legs", root="floating")
    q = gait.stand(robot, contact=partial(FlatFoot, length=0.2, width=0.12))
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    for foot in ("left_sole_link", "right_sole_link"):
        np.testing.assert_allclose(data.oMf[robot.frame(foot)].rotation[:, 2], [0.0, 0.0, 1.0], atol=1e-8)


def test_a_sensor_on_a_foot_is_no_foot() -> None:
    assert gait.feet_of(rt.load("alexander", root="floating"), None) == ("LEFT_FOOT", "RIGHT_FOOT")


def test_the_given_height_is_reached() -> None:
    robot = rt.load("solo12", root="floating")
    q = gait.stand(robot, height=0.15)
    assert pin.centerOfMass(robot.model, robot.model.createData(), q)[2] == pytest.approx(0.15, abs=2e-3)


def test_a_robot_without_feet_names_the_ends_of_its_limbs() -> None:
    robot = rt.load("ur5", root="floating")
    with pytest.raises(rt.InputError, match="wrist_3_link"):
        gait.stand(robot)


def test_a_humanoid_with_straight_knees_crouches() -> None:
    """The knees of g1 bend to both sides of zero, to one of them by 5 degrees only."""
    robot, sole = rt.load("g1", root="floating"), partial(FlatFoot, length=0.15, width=0.05, offset=(0.03, 0, -0.03))
    feet = ("left_ankle_roll_link", "right_ankle_roll_link")
    q = gait.stand(robot, feet, sole, height=0.5)
    assert pin.centerOfMass(robot.model, robot.model.createData(), q)[2] == pytest.approx(0.5, abs=0.05)
    assert q[7 + robot.joint_names.index("left_knee_joint") - 1] > 0.5


def test_knees_at_their_limits_bend_further_so_that_legs_can_extend() -> None:
    """Where zero lies outside the knees' limits, the neutral configuration is at these limits."""
    bent = {"FL_KFE": (-2.6, -1.6), "FR_KFE": (-2.6, -1.6), "HL_KFE": (1.6, 2.6), "HR_KFE": (1.6, 2.6)}
    robot = rt.load("solo12", root="floating", limits={"position": bent})
    q, free = gait.stand(robot), gait.stand(rt.load("solo12", root="floating"))
    knees = [7 + robot.joint_names.index(name) - 1 for name in bent]
    assert np.all(np.abs(q[knees]) > 1.65) and np.all(np.abs(free[knees]) < 1.65)


def sized(name: str, root: str, factor: float) -> rt.Robot:
    """Return a robot with all lengths times a factor, made of the same material."""
    model = rt.load(name).model.copy()
    for i in range(model.njoints):
        place, body = model.jointPlacements[i], model.inertias[i]
        model.jointPlacements[i] = pin.SE3(place.rotation, factor * place.translation)
        model.inertias[i] = pin.Inertia(factor**3 * body.mass, factor * body.lever, factor**5 * body.inertia)
    for frame in model.frames:
        frame.placement = pin.SE3(frame.placement.rotation, factor * frame.placement.translation)
    model.upperEffortLimit = factor**4 * model.upperEffortLimit
    model.lowerEffortLimit = factor**4 * model.lowerEffortLimit
    return rt.load(model, root=root)


@pytest.mark.filterwarnings("ignore:.*Implausible effort limit")
@pytest.mark.parametrize(("name", "root"), [("five_link", "planar"), ("solo12", "floating"), ("bolt", "floating")])
@pytest.mark.parametrize("factor", [0.05, 2.0])
def test_a_robot_of_another_size_stands_in_the_same_posture(name: str, root: str, factor: float) -> None:
    one, other = (gait.stand(sized(name, root, size)) for size in (1.0, factor))
    lengths = slice(0, 2 if root == "planar" else 3)
    other[lengths] /= factor
    np.testing.assert_allclose(other, one, atol=1e-5)


def test_the_defaults_of_lengths_follow_the_size_of_the_robot() -> None:
    small = sized("five_link", "planar", 0.1)
    air = [float(gait.jump(each).phases[1].duration) for each in (sized("five_link", "planar", 1.0), small)]
    assert air[1] == pytest.approx(np.sqrt(0.1) * air[0])
    # A margin of 3 cm would leave no room on treads of 4 cm.
    gait.stairs(small, start=0.02, run=0.04, rise=0.01, count=1)


def test_a_crouch_is_one_of_the_legs_alone() -> None:
    feet = ("left_ankle_roll_link", "right_ankle_roll_link")
    robot = rt.load("g1", root="floating")
    sole = partial(rt.FlatFoot, length=0.15, width=0.05, offset=(0.03, 0, -0.03))
    low = gait.stand(robot, feet, sole, height=0.55)
    others = [7 + i for i, name in enumerate(robot.joint_names[1:]) if name.startswith("waist")]
    assert len(others) == 3 and np.all(np.abs(low[others]) < 0.1)
    # A twisted torso would need unlike legs.
    np.testing.assert_allclose(low[[10, 16]], low[10], atol=0.01)


def test_soles_that_limits_keep_from_their_places_lie_flat_beside_them() -> None:
    """In simple_humanoid's file an ankle has another joint's limits, and its neutral places are out of reach."""
    robot = rt.load("simple_humanoid", root="floating")
    sole, feet = partial(rt.FlatFoot, length=0.2, width=0.1, offset=(0.0, 0.0, -0.1)), ("l_ankle", "r_ankle")
    q = rt.gait.stand(robot, feet, sole)
    stance = BalancedStance(robot, tuple(sole(foot).bound_to(robot) for foot in feet))
    rows, _ = stance.places(q, stance.locate(q))
    np.testing.assert_allclose(rows, 0.0, atol=1e-9)
    lower, upper = robot.limits.position_lower[6:], robot.limits.position_upper[6:]
    assert np.all((q[7:] >= lower - 1e-12) & (q[7:] <= upper + 1e-12))
