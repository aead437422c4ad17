"""Numbers of a URDF that cannot be read are refused by name; those that cannot be right are warned of."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

ARM = (
    '<robot name="arm"><link name="base"/><link name="upper"><inertial><origin xyz="0 0 -0.3" rpy="0 0 0"/>'
    '<mass value="2"/><inertia ixx="0.2" iyy="0.3" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<visual><origin xyz="0 0 0.5"/><geometry><box size="1 1 1"/></geometry></visual></link>'
    '<joint name="elbow" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 1" rpy="0 0 0"/>'
    '<axis xyz="0 1 0"/><limit lower="-1" upper="2" velocity="3" effort="4"/><dynamics damping="0.1"/></joint></robot>'
)
NO_NUMBERS = ["nan", "inf", "-inf", "1e999", "", "one", "1_0", "0x1"]

REFUSED = {
    "origin of a joint": ('xyz="0 0 1"', 'xyz="0 0 {}"', "joint 'elbow' has an origin with xyz="),
    "angles of a joint": ('xyz="0 0 1" rpy="0 0 0"', 'rpy="0 {} 0"', "joint 'elbow' has an origin with rpy="),
    "origin of an inertia": ('xyz="0 0 -0.3"', 'xyz="{} 0 0"', "link 'upper' has an origin with xyz="),
    "origin of a shape": ('xyz="0 0 0.5"', 'xyz="{} 0 0"', "link 'upper' has an origin with xyz="),
    "moment of inertia": ('ixx="0.2"', 'ixx="{}"', "link 'upper' has the inertia ixx="),
    "product of inertia": ('iyz="0"', 'iyz="{}"', "link 'upper' has the inertia iyz="),
    "mass": ('value="2"', 'value="{}"', "link 'upper' has the mass"),
    "axis": ('xyz="0 1 0"', 'xyz="0 {} 0"', "joint 'elbow' has the axis"),
    "limit of the position": ('lower="-1"', 'lower="{}"', "joint 'elbow' has <limit lower="),
    "limit of the effort": ('effort="4"', 'effort="{}"', "joint 'elbow' has <limit effort="),
    "damping": ('damping="0.1"', 'damping="{}"', "joint 'elbow' has <dynamics damping="),
}


UNLIMITED = {
    ("limit of the effort", "inf"): lambda limits: np.isfinite(limits.effort[0]),
    ("limit of the position", "-inf"): lambda limits: np.isfinite(limits.position_lower[0]),
    ("limit of the position", "inf"): lambda limits: limits.position_lower[0] < limits.position_upper[0],
}
"""Infinities that state no limit, or a range without room; what of the limits does not hold then."""


@pytest.mark.parametrize("text", NO_NUMBERS)
@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_finite_number_is_refused_by_name(case, text, urdf):
    old, new, part = REFUSED[case]
    assert old in ARM
    if (case, text) in UNLIMITED:
        assert not UNLIMITED[case, text](rt.load(urdf.text(ARM.replace(old, new.format(text)))).limits)
        return
    with pytest.raises(rt.InputError, match=part):
        rt.load(urdf.text(ARM.replace(old, new.format(text))))


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        (' ixx="0.2"', "", "link 'upper' has the inertia ixx=''"),
        ('<mass value="2"/>', "", "link 'upper' has the mass ''"),
        ('xyz="0 0 1"', 'xyz="0 1"', "joint 'elbow' has an origin with xyz='0 1'"),
        ('xyz="0 0 1"', 'xyz="0 0 0 1"', "joint 'elbow' has an origin with xyz='0 0 0 1'"),
        ('velocity="3"', 'velocity="-3"', "joint 'elbow' has the velocity limit -3; give a magnitude"),
        ('effort="4"', 'effort="-4"', "joint 'elbow' has the effort limit -4; give a magnitude"),
        (' effort="4"', "", "joint 'elbow' has a <limit> without effort"),
        ('lower="-1"', 'lower="nan"', "joint 'elbow' has <limit lower='nan'>"),
    ],
)
def test_missing_and_surplus_numbers_are_refused_by_name(old, new, part, urdf):
    assert old in ARM
    with pytest.raises(rt.InputError, match=part):
        rt.load(urdf.text(ARM.replace(old, new)))


@pytest.mark.parametrize("case", REFUSED)
def test_blanks_around_numbers_change_nothing(case, urdf):
    """Macros leave blanks. The parser behind Pinocchio replaced a mass that one follows by 0, and nothing said so."""
    old = REFUSED[case][0]
    key, number = old.rsplit('="', 1)
    spaced = ARM.replace(old, f'{key}="\n {number[:-1]} \t"')
    assert spaced != ARM
    assert rt.load(urdf.text(spaced)).model == rt.load(urdf.text(ARM)).model


def test_all_faults_are_in_one_message(urdf):
    text = ARM.replace('ixx="0.2"', 'ixx="nan"').replace('xyz="0 0 1"', 'xyz="0 0 inf"')
    with pytest.raises(rt.InputError, match=r"joint 'elbow'.*; link 'upper'"):
        rt.load(urdf.text(text))


WARNED = {
    "triangle inequality": ('iyy="0.3"', 'iyy="0.9"', "Link 'upper' has the principal moments.*sum of the others"),
    "inertia without mass": ('<mass value="2"/>', '<mass value="0"/>', "Link 'upper' has .* but no mass"),
    "huge effort": ('effort="4"', 'effort="1e9"', r"Implausible effort limit of elbow \(1e\+09 N m\)"),
    "millimetres": ('<origin xyz="0 0 -0.3"', '<origin xyz="0 0 -300"', "weighs 2 kg and reaches 300.* in mm"),
    "tiny velocity": ('velocity="3"', 'velocity="1e-9"', "Joint 'elbow' has the implausible velocity limit 1e-09"),
    "no effort": ('effort="4"', 'effort="0"', "effort limit 0 locks it"),
    "inverted positions": ('lower="-1"', 'lower="5"', r"position limits \[5, 2\] are inverted"),
    "no mass": (ARM[ARM.index("<inertial>") : ARM.index("<visual>")], "", "No mass moves with 'elbow'"),
}


@pytest.mark.parametrize("case", WARNED)
def test_what_cannot_be_right_is_warned_of_and_printed(case, urdf):
    old, new, part = WARNED[case]
    assert old in ARM
    with pytest.warns(UserWarning, match=part) as caught:
        robot = rt.load(urdf.text(ARM.replace(old, new)))
    assert [warning.filename for warning in caught] == [__file__]
    assert re.search(part, " ".join(str(robot).split()))


@pytest.mark.parametrize("axis", ["0 1 0", "0 3 0", "0 1e-5 0"])
def test_a_sound_arm_loads_without_a_warning_whatever_the_length_of_its_axis(axis, urdf):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = rt.load(urdf.text(ARM.replace('<axis xyz="0 1 0"', f'<axis xyz="{axis}"')))
    pull = pin.rnea(robot.model, robot.model.createData(), np.full(1, 0.5), np.zeros(1), np.zeros(1))
    assert pull[0] == pytest.approx(-2 * 9.81 * 0.3 * np.sin(-0.5))


def test_effort_limits_far_beyond_the_weight_are_noted() -> None:
    """Solo12 weighs 2.5 kg, and its URDF allows 1000 N m."""
    (note,) = (note for note in rt.load("solo12").notes if "Implausible effort limit" in note)
    assert "of FL_HAA (1000 N m) and 11 more" in note
    assert "No motion needs as much, so this limit never holds one back" in note and "limits={'effort': ...}" in note
    assert not any(
        "Implausible" in note for name in ("ur3", "panda", "so100", "talos_legs") for note in rt.load(name).notes
    )
