"""Footholds on which no configuration stands are refused before a solve, with a step that would do."""

from __future__ import annotations

import re
import time
from functools import partial

import pytest

import robotraj as rt


@pytest.mark.parametrize("name", ["sidestep", "gap"])
def test_footholds_out_of_reach_between_steps_are_refused_within_two_seconds(name: str) -> None:
    robot = rt.load("talos_legs" if name == "sidestep" else "go2", root="floating")
    began = time.process_time()
    with pytest.raises(rt.InputError, match=r"cannot stand on the footholds after step \d.*Steps of 0\.\d+ m would do"):
        if name == "sidestep":
            rt.gait.sidestep(robot, distance=3.0)
        else:
            rt.gait.gap(robot, start=0.3, width=2.0, step_length=0.2)
    assert time.process_time() - began < 2.0


def test_a_rise_that_the_legs_do_not_reach_is_named() -> None:
    robot = rt.load("go2", root="floating")
    told = r"0\.\d+ m in mean height.*A rise of (0\.\d+) m would do"
    with pytest.raises(rt.InputError, match=told) as refusal:
        rt.gait.stairs(robot, start=0.3, run=0.3, rise=0.6, count=2)
    rise = float(re.search(told, str(refusal.value))[1])  # type: ignore[index]
    assert rise > 0.1
    rt.gait.stairs(robot, start=0.3, run=0.3, rise=rise, count=2)


def test_a_rise_whose_treads_are_out_of_reach_as_well_names_a_step() -> None:
    robot = rt.load("go2", root="floating")
    with pytest.raises(rt.InputError, match=r"m in mean height.*Steps of 0\.\d+ m would do"):
        rt.gait.stairs(robot, start=0.3, run=1.5, rise=0.6, count=1)


def test_long_steps_that_the_legs_reach_are_not_refused() -> None:
    robot = rt.load("talos_legs", root="floating")
    rt.gait.start_stop(robot, step_length=0.6)
    rt.gait.sidestep(robot, distance=0.5)


TALOS = {"feet": ("left_sole_link", "right_sole_link"), "contact": partial(rt.FlatFoot, length=0.2, width=0.12)}


def test_a_turn_takes_as_many_steps_as_keep_the_feet_apart() -> None:
    robot = rt.load("talos_legs", root="floating")
    with pytest.raises(rt.InputError, match="leg_right_6_link and leg_left_6_link of 'talos_legs' overlap"):
        rt.gait.turn(robot, angle=0.45, count=2, **TALOS)
    for angle, count, standing in (
        (0.2, 2, "right_sole_link"),
        (0.45, 4, "right_sole_link"),
        (-0.45, 4, "left_sole_link"),
    ):
        phases = [phase for phase in rt.gait.turn(robot, angle=angle, **TALOS).phases if phase.name.startswith("step")]
        assert len(phases) == count
        assert [contact.label for contact in phases[0].contacts] == [standing]


def test_point_feet_turn_in_two_steps() -> None:
    problem = rt.gait.turn(rt.load("bolt", root="floating"), angle=1.5, feet=("FL_FOOT", "FR_FOOT"))
    assert sum(phase.name.startswith("step") for phase in problem.phases) == 2


@pytest.mark.slow
def test_the_stated_sidestep_is_planned() -> None:
    robot = rt.load("talos_legs", root="floating")
    with pytest.raises(rt.InputError) as refusal:
        rt.gait.sidestep(robot, distance=3.0)
    distance = float(re.search(r"Steps of (\S+) m would", str(refusal.value))[1])  # type: ignore[index]
    assert rt.plan(rt.gait.sidestep(robot, distance=distance)).success
