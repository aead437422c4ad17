"""Arguments of another kind than annotated are named after a call failed; values that fit are never blamed."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj._util.names.kinds import misfit

ARM = rt.load("two_link_arm")
MOVE = rt.Phase(ARM, 5.0, rt.State(q=0, v=0), rt.State(q=0.3, v=0), rt.Effort())

WRONG: dict[str, Callable[[], object]] = {
    "robot= of rt.gait.walk must be a Robot as returned by rt.load; got 'talos'": lambda: rt.gait.walk("talos"),
    "robot= of rt.gait.feet_of must be a Robot": lambda: rt.gait.feet_of(3, None),
    "solution= of rt.override must be a Solution as returned by rt.plan; got <Phase": lambda: rt.override(MOVE, 0.5),
    "travel= of rt.robot.on_rail must be 2 numbers; got 0.1": lambda: rt.robot.on_rail(ARM, 9.0, 0.1, 1.0, 9.0),
    "control= of HermiteSimpson must be a Control": lambda: rt.plan(MOVE, rt.Mesh(3, rt.HermiteSimpson(control=2))),
    "candidates= of OneOf must be a list: each a Constraint": lambda: rt.constraints.OneOf(np.array([1, 2])),
    "level= of Flat must be a number; got Fraction": lambda: rt.terrain.Flat(level=Fraction(1, 3)),
    "level= of Flat must be a number; got SX": lambda: rt.terrain.Flat(level=ca.SX.sym("h")),
    "axis= of Turning must be 3 numbers; got {'z': 1}": lambda: rt.gait.Turning(axis={"z": 1}),
    "model= of Limits.of must be a Model": lambda: ARM.limits.of("arm.urdf"),
    "of Guess named 'tme'": lambda: rt.Guess(tme=[0, 1]),
}


@pytest.mark.parametrize("text", WRONG)
def test_the_argument_of_another_kind_is_named(text: str) -> None:
    with pytest.raises(rt.InputError, match=text):
        WRONG[text]()


def takes(value: Any) -> None:
    """Take anything; the fields of values are compared with their own annotations."""


@pytest.mark.parametrize("name", ["solo12", "five_link"])
def test_values_that_were_accepted_fit_their_annotations(name: str) -> None:
    robot = rt.load(name, root="floating" if name == "solo12" else "planar")
    gait = rt.gait.trot if name == "solo12" else rt.gait.walk
    walk = gait(robot, step_length=0.2, duration=0.4)
    box = rt.obstacles.Box((0.1, 0.1, 0.1), position=(3.0, 0.0, 0.0))
    free = MOVE.with_(constraints=[rt.CollisionFree([box])])
    place = rt.AtEnd(rt.FramePosition("tip", [1, None, 0]))
    solution = rt.plan(MOVE, mesh=rt.Mesh(8))
    for value in (walk, free, place, rt.Problem([MOVE]), solution, rt.validate(solution), rt.Ipopt()):
        assert misfit(takes, "takes", {"value": value}) == ""


def test_entries_and_fields_inside_are_looked_at() -> None:
    broken = rt.constraints.MotorPower(limit=3.0)
    object.__setattr__(broken, "limit", object)
    assert "limit= of MotorPower must be" in misfit(takes, "takes", {"value": [1, {"a": (broken,)}]})


ANSWERS: dict[str, Callable[[], object]] = {
    r"got str 'ur5'\. Write rt\.Phase\(rt\.load\('ur5'\), duration, \.\.\.\)": lambda: rt.Phase("ur5", 2.0),
    r"got float 2\.0\. Write rt\.Phase\(robot, duration, \.\.\.\)": lambda: rt.Phase(2.0, ARM),
    r"such as rt\.State\(q=\.\.\., v=0\); got \[0, 1\]": lambda: rt.Phase(ARM, 2.0, [0, 1]),
    r"got 'hermite'": lambda: rt.Mesh(10, "hermite"),
    r"named 'Cube'\. Did you mean 'Box'": lambda: rt.obstacles.Cube,
}


@pytest.mark.parametrize("text", ANSWERS)
def test_a_mistake_of_the_first_hour_is_answered_by_what_to_write(text: str) -> None:
    with pytest.raises(rt.InputError, match=text):
        ANSWERS[text]()
