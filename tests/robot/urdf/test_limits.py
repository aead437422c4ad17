"""Accelerations, jerks and soft limits of a URDF hold in plans; what is not read is named once."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import robotraj as rt

SLIDE = (
    '<robot name="slide"><link name="base"/><link name="cart"><inertial><mass value="2"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="x" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>'
    '<limit lower="-5" upper="5" velocity="3" effort="30"{}/>{}</joint></robot>'
)
SOFT = '<safety_controller soft_lower_limit="{}" soft_upper_limit="{}" k_position="100" k_velocity="10"/>'


def load(urdf, limit="", more=""):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return rt.load(urdf.text(SLIDE.format(limit, more)))


def fastest(robot, distance):
    ends = rt.State(q=[0], v=0), rt.State(q=[distance], v=0)
    return rt.plan(rt.Phase(robot, (0.05, 20), *ends, rt.Duration()), progress=False)


@pytest.mark.parametrize("prefix", ["", "drake:"])
def test_accelerations_of_the_file_hold(urdf, prefix):
    """From rest to rest over d with |a| <= A: T = 2 sqrt(d / A)."""
    text = SLIDE.format(f' {prefix}acceleration="2"', "")
    if prefix:
        text = text.replace("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ')
    robot = rt.load(urdf.text(text))
    np.testing.assert_array_equal(robot.limits.acceleration, [2.0])
    solution = fastest(robot, 2.0)
    assert solution.duration == pytest.approx(2.0, rel=1e-3)
    assert rt.validate(solution).passed


def test_jerks_of_the_file_hold(urdf):
    robot = load(urdf, ' acceleration="2" jerk="20"')
    np.testing.assert_array_equal(robot.limits.jerk, [20.0])
    solution = fastest(robot, 2.0)
    times = np.linspace(0.0, solution.duration, 4001)[1:-1]
    rates = np.diff(solution.at(times).a[:, 0]) / np.diff(times)
    assert np.max(np.abs(rates)) < 20.0 * (1.0 + 1e-2)
    assert rt.validate(solution).passed
    free = rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=1, v=0), limits=robot.limits.with_(jerk=np.inf))
    assert "jerk" in str(rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=1, v=0)))
    assert "jerk" not in str(free)


def test_positions_stay_within_soft_limits(urdf):
    robot = load(urdf, more=SOFT.format(-0.5, 6))
    assert (robot.limits.position_lower[0], robot.limits.position_upper[0]) == (-0.5, 5.0)
    with pytest.raises(rt.InputError, match=r"outside its position limit \[-0.5, 5\]"):
        rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=-1, v=0))


def test_soft_limits_without_room_are_named_and_not_used(urdf):
    with pytest.warns(UserWarning, match=r"Soft limits that leave no motion are not used: 'x'"):
        robot = rt.load(urdf.text(SLIDE.format("", SOFT.format(0, 0))))
    assert robot.limits.position_upper[0] == 5.0


def test_attributes_that_are_not_read_are_named_in_one_warning(urdf):
    text = SLIDE.format(' current="3" gear_velocity="9"', '<dynamics damping="1" stiffness="4"/>')
    with pytest.warns(UserWarning) as caught:
        rt.load(urdf.text(text.replace('<mass value="2"/>', '<mass value="2" density="1000"/>')))
    (warning,) = (str(each.message) for each in caught)
    names = "<limit current>, <limit gear_velocity>, <dynamics stiffness>, <mass density>"
    assert f"Attributes that robotraj does not read: {names}." in warning


def test_degrees_are_doubted_and_missing_positions_are_named(urdf):
    turn = '<limit lower="-180" upper="180" velocity="3" effort="4"/>'
    with pytest.warns(UserWarning, match=r"plausible in degrees: 'a' \(the first has \[-180, 180\]\)"):
        rt.load(urdf.chain(("a", "revolute", "0 1 0", turn)))
    with pytest.warns(
        UserWarning, match=r"Joint 'a' cannot be planned .* position limits are missing.*locked={'a': 0}"
    ):
        robot = rt.load(urdf.chain(("a", "revolute", "0 1 0", '<limit velocity="3" effort="4"/>')))
    assert robot.limits.missing == ("a",)
    assert robot.limits.with_(position=1.0).missing == ()


@pytest.mark.parametrize(
    ("added", "message"),
    [
        ('<loop_joint name="rod" type="revolute"/>', "Joints that close loops are not read: 'rod'.*LoopClosure"),
        (
            '<link name="tray"/><joint name="tray" type="planar"><parent link="cart"/><child link="tray"/>'
            '<limit effort="9" velocity="1"/></joint>',
            "A <limit> of planar and floating joints is not read: 'tray'",
        ),
        (
            '<link name="camera"/><joint name="camera" type="fixed"><parent link="cart"/><child link="camera"/>'
            '<origin rpy="0 90 0"/></joint>',
            "rpy in rad that is plausible in degrees: '0 90 0'",
        ),
    ],
)
def test_what_changes_a_motion_and_is_not_read_as_meant_is_named(urdf, added, message):
    with pytest.warns(UserWarning, match=message):
        rt.load(urdf.text(SLIDE.format("", "").replace("</robot>", f"{added}</robot>")))


def test_an_effort_without_limit_is_infinite(urdf):
    robot = load(urdf)
    assert np.isfinite(robot.limits.effort[0])
    endless = rt.load(
        urdf.text(
            SLIDE.replace('effort="30"', 'effort="inf"').replace('velocity="3"', 'velocity="Infinity"').format("", "")
        )
    )
    assert np.isposinf([endless.limits.effort[0], endless.limits.velocity[0]]).all()
