"""Constructors that take numbers and names refuse every other value by an InputError."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.checks import number, whole

STRANGE = ("x", [], object(), np.zeros((3, 3)), 1j, b"x", lambda point: 1, np.array(["a"]), [[1, 2], [3]], {1: 2})


def system(**changed: object) -> rt.System:
    return rt.System(**{"states": ["x"], "controls": ["u"], "dynamics": lambda point: [point.u["u"]], **changed})


NAMES, EMPTY, TEXT, FUNCTION = 7, 1, 0, 6
"""Places in ``STRANGE`` of what is right somewhere: a list of names, an empty list, a string, a function."""

PLACES: dict[str, tuple[Callable[[object], object], tuple[int, ...]]] = {
    "states": (lambda value: system(states=value), (NAMES,)),
    "controls": (lambda value: system(controls=[value]), (TEXT,)),
    "algebraic": (lambda value: system(algebraic=[value]), (TEXT,)),
    "units": (lambda value: system(units=value), ()),
    "dynamics": (lambda value: system(dynamics=value), (FUNCTION,)),
    "name": (lambda value: system(name=value), (TEXT,)),
    "intervals": (lambda value: rt.Mesh(value), ()),
    "least": (lambda value: rt.schemes.MovingMesh(10, least=value), ()),
    "obstacles": (lambda value: rt.CollisionFree(value), (EMPTY,)),
    "srdf": (lambda value: rt.CollisionFree([], srdf=value), (EMPTY,)),
    "vertices": (lambda value: rt.obstacles.ConvexMesh(value), ()),
    "obstacle": (lambda value: rt.obstacles.Sphere(0.1, name=value), (TEXT,)),
    "braking": (lambda value: rt.objectives.MechanicalWork(braking=value), ()),
    "tolerance": (lambda value: rt.schemes.Adaptive(tolerance=value), ()),
    "most": (lambda value: rt.refinement.Equidistribute(most=value), ()),
    "threads": (lambda value: rt.engines.Native(threads=value), ()),
    "jobs": (lambda value: rt.engines.Compiled(jobs=value), ()),
    "root": (lambda value: rt.load("pendulum", root=value), ()),
    "actuated": (lambda value: rt.load("pendulum", actuated=value), (EMPTY,)),
}


@pytest.mark.parametrize("place", PLACES)
def test_what_is_no_number_or_name_is_refused(place: str) -> None:
    make, right = PLACES[place]
    for i, value in enumerate(STRANGE):
        if i not in right:
            with pytest.raises(rt.InputError):
                make(value)


@pytest.mark.parametrize("value", [math.nan, -math.inf, -1e-300, 1.1, 10**400, -(10**400), True, "1", None, 1j])
def test_a_number_outside_its_bounds_is_refused_in_a_short_message(value: object) -> None:
    with pytest.raises(rt.InputError, match="share must be a number from 0 to 1") as caught:
        number("share", value, 0.0, 1.0)
    assert len(str(caught.value)) < 120


@pytest.mark.parametrize("value", [0, 0.0, 1, np.float32(0.5), np.int8(1), 5e-324])
def test_a_number_within_its_bounds_becomes_a_float(value: float) -> None:
    found = number("share", value, 0.0, 1.0)
    assert type(found) is float and found == value


def test_an_integer_beyond_all_floats_is_refused_without_an_upper_bound() -> None:
    assert number("seconds", math.inf, 0.0) == math.inf
    assert number("seconds", int(sys.float_info.max), 0.0) == sys.float_info.max
    with pytest.raises(rt.InputError, match="of at least 0 s, got an integer of more than"):
        number("seconds", 10**5000, 0.0, unit="s")


@pytest.mark.parametrize("value", [0, 11, 1.0, True, math.nan, "3", 10**400])
def test_an_integer_outside_its_bounds_is_refused(value: object) -> None:
    assert whole("periods", np.int32(10), 1, 10) == 10
    with pytest.raises(rt.InputError, match="periods must be a whole number from 1 to 10"):
        whole("periods", value, 1, 10)
