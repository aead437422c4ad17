"""Limits that makers publish are used by name, and printed where a robot does not have them."""

import numpy as np
import pytest

import robotraj as rt

LOCKED = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}


def test_the_limits_of_a_panda_are_those_of_libfranka():
    robot = rt.load("panda", locked=LOCKED, limits=rt.robot.maker_limits("panda"))
    np.testing.assert_array_equal(robot.limits.acceleration, [15, 7.5, 10, 12.5, 15, 20, 20])
    np.testing.assert_array_equal(robot.limits.jerk, 500.0 * robot.limits.acceleration)
    assert "maker" not in str(robot)


def test_a_robot_without_its_makers_limits_is_printed_with_the_call_that_sets_them():
    assert "rt.robot.maker_limits('panda')" in " ".join(str(rt.load("panda", locked=LOCKED)).split())
    assert "maker_limits" not in str(rt.load("ur5"))


def test_a_robot_that_the_table_lacks_is_refused():
    with pytest.raises(rt.UnknownName, match="panda"):
        rt.robot.maker_limits("ur5")
