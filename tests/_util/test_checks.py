"""Constructors that take numbers and names refuse every other value by an InputError."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import robotraj as rt

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
