"""Windows of the natural time of a robot: a smaller one falls faster."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.size.reach import reach
from robotraj.robot.size.state_sizes import WINDOW, error_window


def chain(*lengths: float) -> rt.Robot:
    """Return links of these lengths, one behind the other, each with its mass at its end."""
    model, parent, place = pin.Model(), 0, pin.SE3.Identity()
    for i, length in enumerate(lengths):
        parent = model.addJoint(parent, pin.JointModelRY(), place, f"hinge {i}")
        place = pin.SE3(np.eye(3), np.array([0.0, 0.0, length]))
        model.appendBodyToJoint(parent, pin.Inertia(1.0, np.zeros(3), np.zeros((3, 3))), place)
    return rt.load(model)


def test_the_reach_is_the_longest_path_through_the_joints() -> None:
    assert reach(chain(0.3, 0.2, 0.1).model) == pytest.approx(0.6)


def test_the_place_of_the_first_joint_adds_nothing_to_the_reach() -> None:
    high = chain(0.3, 0.2).model.copy()
    high.jointPlacements[1] = pin.SE3(np.eye(3), np.array([0.0, 0.0, 1.0]))
    assert reach(high) == pytest.approx(0.5)


def test_windows_of_small_robots_are_as_much_shorter_as_their_natural_time() -> None:
    assert error_window(chain(0.02, 0.0115)) == pytest.approx(0.3 * WINDOW)
    assert error_window(chain(1.0, 0.5)) == WINDOW


def test_nothing_amplifies_the_errors_of_a_body_without_reach() -> None:
    assert error_window(chain(0.0)) == WINDOW
