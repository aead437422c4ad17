"""The note of a robot whose left and right joints have different limits."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

import robotraj as rt

Given = tuple[float, float, float, float]

PAIR = """<robot name="pair">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
{sides}
</robot>"""
SIDE = """
  <link name="{side}"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="{side}_hip" type="revolute"><parent link="base"/><child link="{side}"/><axis xyz="1 0 0"/>
    <limit lower="{low}" upper="{high}" velocity="{speed}" effort="{effort}"/></joint>"""


def pair(folder: Path, *limits: Given) -> Path:
    """Write a URDF with a left and a right hip of these lowest and highest positions, speeds and efforts."""
    keys = ("low", "high", "speed", "effort")
    written = [
        SIDE.format(side=side, **dict(zip(keys, given, strict=True)))
        for side, given in zip(("left", "right"), limits, strict=True)
    ]
    path = folder / "pair.urdf"
    path.write_text(PAIR.format(sides="".join(written)))
    return path


@pytest.mark.parametrize(
    ("right", "told"),
    [
        ((-0.5, 1.5, 6.0, 9.0), r"positions of 'left_hip' \[-0.5, 1\] rad, of 'right_hip' \[-0.5, 1.5\] rad"),
        ((-1.0, 0.5, 5.0, 9.0), "speed of 'left_hip' 6 rad/s, of 'right_hip' 5 rad/s"),
        ((-0.5, 1.0, 6.0, 90.0), "effort of 'left_hip' 9 N m, of 'right_hip' 90 N m"),
    ],
)
def test_limits_that_differ_between_the_sides_are_told(right: Given, told: str, tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match=f"Left and right have different limits: {told}"):
        rt.load(pair(tmp_path, (-0.5, 1.0, 6.0, 9.0), right))


@pytest.mark.parametrize("right", [(-0.5, 1.0, 6.0, 9.0), (-1.0, 0.5, 6.0, 9.0)])
def test_equal_or_mirrored_limits_are_not_told(right: Given, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.load(pair(tmp_path, (-0.5, 1.0, 6.0, 9.0), right))


def test_corrected_limits_and_a_weak_side_by_choice_are_not_told(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.load(pair(tmp_path, (-0.5, 1.0, 6.0, 9.0), (-0.5, 1.0, 6.0, 90.0)), limits={"effort": {"right_hip": 9.0}})
        rt.load(pair(tmp_path, (-0.5, 1.0, 6.0, 9.0), (-0.5, 1.0, 6.0, 9.0)), limits={"effort": {"right_hip": 3.0}})


def test_the_shifted_limits_of_simple_humanoid_are_noted_and_right_robots_have_no_such_note() -> None:
    def told(name: str) -> bool:
        return any("Left and right" in note for note in rt.load(name).notes)

    assert told("simple_humanoid")
    assert not any(map(told, ("talos", "solo12", "bolt", "g1", "romeo", "baxter")))
