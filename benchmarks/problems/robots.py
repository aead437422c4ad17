"""The mechanisms of the table as robots: their URDFs in place of written equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

import robotraj as rt

from .case import Case


def rest(*q: float) -> rt.State:
    """Not moving."""
    return rt.State(q=list(q), v=0)


def robots(systems: Mapping[str, Case]) -> list[Case]:
    """Block, cart-pole, acrobot, pendulum and arm, with the optima of the equations they must agree with."""
    half = np.pi / 2
    poses = [[0, 0], [-half, half], [half, half], [np.pi, 0]]  # the elbow is the difference of the absolute angles
    fast, effort = rt.Duration(), rt.Effort()
    problems = {
        "double_integrator": (rt.Phase(rt.load("block"), (0, 200), rest(10), rest(0), fast), rt.guess.StraightLine(10)),
        "cartpole": (rt.Phase(rt.load("cartpole"), 2.0, rest(0, 0), rest(1, np.pi), effort), rt.guess.StraightLine()),
        "acrobot": (
            rt.Phase(rt.load("acrobot"), 2.0, rest(0, 0), rest(np.pi, 0), effort),
            rt.guess.Keyframes([0, 0.25, 0.75, 1], [rt.State(q=pose) for pose in poses]),
        ),
        "pendulum": (rt.Phase(rt.load("pendulum"), (0.5, 2.5), rest(0), rest(np.pi), effort), rt.guess.StraightLine(1)),
        "two_link_arm": (
            rt.Phase(rt.load("two_link_arm"), (1, 10), rest(0, 0.5), rest(0.522, 0.5), fast),
            rt.guess.StraightLine(3),
        ),
    }
    return [
        replace(systems[name], name=f"{name}, URDF", problem=problem, guess=guess)
        for name, (problem, guess) in problems.items()
    ]
