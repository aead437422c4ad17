"""Left and right of a robot by names."""

from __future__ import annotations

import pytest

from robotraj.robot.sides.other_side import other_side


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("left_hip", "right_hip"),
        ("leg_left_1_joint", "leg_right_1_joint"),
        ("FL_HAA", "FR_HAA"),
        ("HR_KFE", "HL_KFE"),
        ("l_knee", "r_knee"),
        ("LHipYaw", "RHipYaw"),
        ("LLEG_KNEE", "RLEG_KNEE"),
        ("RL_calf_joint", "RR_calf_joint"),
        ("lh_foot", "rh_foot"),
        ("torso_1_joint", "torso_1_joint"),
        ("lower_leg", "lower_leg"),
    ],
)
def test_names_change_sides(name: str, other: str) -> None:
    names = [name, other, "flower_leg", "rower_leg", "torso_2_joint"]
    assert other_side(name, names) == other
    assert other_side(other, names) == name
