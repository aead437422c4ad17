"""Springs that a URDF states, for Gazebo or as attributes of SDF, are those of the robot."""

from __future__ import annotations

import pytest

import robotraj as rt

DOOR = (
    '<robot name="door"><link name="wall"/><link name="leaf"><inertial><mass value="2"/><inertia ixx=".1" iyy=".1" '
    'izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="hinge" type="revolute"><parent link="wall"/>'
    '<child link="leaf"/><limit lower="-1" upper="1" velocity="2" effort="1"/><dynamics damping="0.1" {}/></joint>'
    "{}</robot>"
)
GAZEBO = (
    '<gazebo reference="{}"><springStiffness> {} </springStiffness><springReference>0.25</springReference></gazebo>'
)


@pytest.mark.parametrize(
    ("attributes", "gazebo", "springs"),
    [
        ("", "", ()),
        ('spring_stiffness="3"', "", (("hinge", 3.0, 0.0),)),
        ('spring_stiffness="3" spring_reference="0.5"', "", (("hinge", 3.0, 0.5),)),
        ("", GAZEBO.format("hinge", 4), (("hinge", 4.0, 0.25),)),
        ('spring_stiffness="3" spring_reference="0.5"', GAZEBO.format("hinge", 4), (("hinge", 4.0, 0.25),)),
        ("", GAZEBO.format("leaf", 4), ()),
        ('spring_stiffness="0"', "", ()),
    ],
)
def test_a_stated_spring_pulls(attributes, gazebo, springs, urdf):
    path = urdf.text(DOOR.format(attributes, gazebo))
    assert rt.load(path).springs == springs
    assert rt.load(path, springs={"hinge": 7.0}).springs == (("hinge", 7.0, 0.0),)


@pytest.mark.parametrize(
    ("attributes", "gazebo", "part"),
    [
        ('spring_stiffness="stiff"', "", "joint 'hinge' has <dynamics spring_stiffness='stiff'>"),
        ("", GAZEBO.format("hinge", "nan"), "spring of joint 'hinge' has <springStiffness> 'nan'"),
        ("", GAZEBO.format("hinge", -1), "stiffness"),
    ],
)
def test_springs_that_are_no_numbers_are_refused(attributes, gazebo, part, urdf):
    with pytest.raises(rt.InputError, match=part):
        rt.load(urdf.text(DOOR.format(attributes, gazebo)))
