"""Steps that are longer than the legs reach are refused before a solve."""

from __future__ import annotations

import re

import pytest

import robotraj as rt
from robotraj.gait.capability.leg_reach import leg_length


def test_the_length_of_a_leg_is_that_of_its_links() -> None:
    assert leg_length(rt.load("five_link", root="planar"), "left_foot") == pytest.approx(0.8)
    assert leg_length(rt.load("hopper", root="planar"), "foot") == float("inf")


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("name, longest", [("a1", 0.675), ("go2", 0.708), ("solo12", 0.61)])
def test_a_step_too_long_for_the_legs_is_refused_with_one_that_would_do(name: str, longest: float, way: float) -> None:
    """The longest steps are those that the NLP itself allows, 0.675 m of a1: knees do not straighten."""
    robot = rt.load(name, root="floating")
    with pytest.raises(rt.InputError, match=r"stands in place.*as high as .* would do") as refusal:
        rt.gait.trot(robot, step_length=1.06 * longest * way, duration=0.6)
    step = float(str(refusal.value).split("step_length=")[1].split()[0])
    assert 0.4 * longest < way * step < 0.6 * longest
    rt.gait.trot(robot, step_length=0.98 * longest * way, duration=2.0)


def test_a_step_of_one_group_of_four_is_a_quarter_of_the_stride() -> None:
    """A foot stands while two others swing, so that each of these steps is half as long as one of a trot."""
    robot = rt.load("go2", root="floating")
    single = [("RL_foot",), ("FL_foot",), ("RR_foot",), ("FR_foot",)]
    with pytest.raises(rt.InputError, match=r"stands in place for 2 of them.* a step is 0.379 m.*=0.19 would"):
        rt.gait.walk(robot, groups=single, step_length=0.7, duration=0.4)
    with pytest.raises(rt.InputError, match="with duration") as refusal:
        rt.gait.walk(robot, groups=single, step_length=0.3, duration=0.03)
    words = re.search(r"step_length=(\S+) with duration=(\S+) would", str(refusal.value))
    assert words is not None
    length, duration = (float(each) for each in words.groups())
    assert length < 0.1
    rt.gait.walk(robot, groups=single, step_length=length, duration=duration)


def test_a_flight_lengthens_a_step() -> None:
    biped = rt.load("five_link", root="planar")
    rt.gait.run(biped, step_length=2.0, duration=0.6)
    with pytest.raises(rt.InputError, match="step is 1.32 m at most"):
        rt.gait.walk(biped, step_length=1.4, duration=0.6)


def test_feet_are_not_lifted_beyond_the_length_of_a_leg() -> None:
    robot = rt.load("go2", root="floating")
    with pytest.raises(rt.InputError, match="clearance=30 m lifts .* 0.521 m long. clearance=0.052 .* 30 mm are 0.03"):
        rt.gait.trot(robot, step_length=0.1, duration=0.3, clearance=30)
    rt.gait.trot(robot, step_length=0.1, duration=0.3, clearance=0.5)
