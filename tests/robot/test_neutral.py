"""The neutral configuration lies inside the limits; joints moved for that are named."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import catalogue

MOVED = {
    "laikago": ("FL_calf_joint", "zero configuration"),
    "kinova": ("j2s6s200_joint_3", "reference configuration 'arm_up'"),
    "allegro_left_hand": ("joint_12.0", "zero configuration"),
}


@pytest.mark.parametrize("entry", catalogue(), ids=lambda entry: entry.name)
def test_every_robot_of_the_catalogue_loads_with_its_neutral_configuration_inside_its_limits(entry):
    robot = rt.load(entry.name)
    assert robot.nq == robot.nv > 0
    sound = robot.limits.position_lower <= robot.limits.position_upper
    assert np.all((robot.neutral >= robot.limits.position_lower)[sound])
    assert np.all((robot.neutral <= robot.limits.position_upper)[sound])
    if robot.end_effector:
        assert robot.frame(robot.end_effector) > 0


@pytest.mark.parametrize("name", MOVED)
def test_joints_whose_start_lies_outside_are_named(name):
    joint, what = MOVED[name]
    (note,) = [note for note in rt.load(name).notes if "outside the limits" in note]
    assert f"'{joint}' at " in note
    assert what in note


def test_a_start_inside_gives_no_warning():
    assert not any("outside" in note for note in rt.load("panda").notes)


def test_references_of_the_srdf_are_used():
    robot = rt.load("talos")
    assert robot.neutral[robot.joint("leg_left_4_joint")] == 0.859395  # as talos.srdf has it
    assert any("'half_sitting'" in note for note in robot.notes)
    assert rt.load("solo12").neutral[2] != 0
    assert any("'standing'" in note for note in rt.load("solo12").notes)


def test_overridden_limits_move_the_neutral_configuration():
    robot = rt.load("pendulum", limits={"position": (1, 2)})
    assert robot.neutral[0] == 1.0
    assert any("'pivot' at 0 rad, limits [1, 2] rad" in note for note in robot.notes)


def test_a_models_own_reference_is_used_and_nan_refused():
    model = pin.buildSampleModelManipulator()
    model.referenceConfigurations["home"] = np.full(model.nq, 0.1)
    np.testing.assert_array_equal(rt.load(model).neutral, np.full(model.nq, 0.1))
    model.referenceConfigurations["home"] = np.full(model.nq, np.nan)
    with pytest.raises(rt.InputError, match="'home'"):
        rt.load(model)
