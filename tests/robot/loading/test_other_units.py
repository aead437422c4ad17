"""Limits in degrees or millimetres are warned of, in rt.load and in a phase; plausible ones are not."""

import warnings

import numpy as np
import pytest

import robotraj as rt


@pytest.mark.parametrize(
    ("robot", "limits", "message"),
    [
        (
            "ur5",
            {"velocity": 180.0},
            "velocity limit 180 rad/s of 'shoulder_pan_joint' is .* 180 degrees/s are 3.14159",
        ),
        ("ur5", {"position": (-350, 350)}, "position limit -350 rad .* -350 degrees are -6.10865 rad.*kind: 9"),
        ("ur5", {"velocity": {"elbow_joint": 90}}, "90 rad/s of 'elbow_joint' is .* 90 degrees/s are 1.5708 rad/s"),
        ("cartpole", {"position": {"slider": (-2, 1500)}}, "limit 1500 m of .* 1500 mm are 1.5 m"),
    ],
)
def test_limits_in_other_units_are_warned_of(robot, limits, message):
    with pytest.warns(UserWarning, match=message) as caught:
        rt.load(robot, limits=limits)
    assert len(caught) == 1
    own = rt.load(robot)
    with pytest.warns(UserWarning, match=f"Phase 'go': .*{message}") as caught:
        rt.Phase(own, 1.0, rt.State(v=0), None, rt.Effort(), limits=own.limits.with_(**limits), name="go")
    assert len(caught) == 1


@pytest.mark.parametrize(
    "limits",
    [
        {"velocity": 10.0},
        {"velocity": np.inf},
        {"position": np.inf},
        {"velocity": 1.0, "acceleration": 180.0},
        {"effort": 1000.0},
    ],
)
def test_plausible_limits_are_not_warned_of(limits):
    arm = rt.load("ur5")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.Phase(arm, 1.0, rt.State(v=0), None, rt.Effort(), limits=arm.limits.with_(**limits))
        rt.load("ur5", limits=limits)
