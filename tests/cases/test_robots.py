"""The table's mechanisms as robots: a URDF's inverse dynamics give the optima of the written-out equations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import robotraj as rt

TABLE = {case["id"]: case for case in yaml.safe_load((Path(__file__).parent / "systems.yaml").read_text())}
SCHEMES = {
    "trap": rt.schemes.Trapezoidal(),
    "hs": rt.HermiteSimpson(),
    "lecture": rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature()),
    "radau3": rt.schemes.RadauIIA(points=3),
}


def rest(*q: float) -> rt.State:
    return rt.State(q=list(q), v=0)


def block() -> tuple[rt.Phase, rt.guess.StraightLine]:
    phase = rt.Phase(rt.load("block"), (0, 200), rest(10), rest(0), objective=rt.Duration())
    return phase, rt.guess.StraightLine(duration=10)


def cartpole() -> tuple[rt.Phase, rt.guess.StraightLine]:
    phase = rt.Phase(rt.load("cartpole"), 2.0, rest(0, 0), rest(1, np.pi), objective=rt.Effort())
    return phase, rt.guess.StraightLine()


def acrobot() -> tuple[rt.Phase, rt.guess.Keyframes]:
    """Relative angles: the elbow is q2 - q1 of the literature."""
    phase = rt.Phase(rt.load("acrobot"), 2.0, rest(0, 0), rest(np.pi, 0), objective=rt.Effort())
    half = np.pi / 2
    poses = [[0, 0], [-half, half], [half, half], [np.pi, 0]]
    return phase, rt.guess.Keyframes([0, 0.25, 0.75, 1], [rt.State(q=pose) for pose in poses])


def pendulum() -> tuple[rt.Phase, rt.guess.StraightLine]:
    phase = rt.Phase(rt.load("pendulum"), (0.5, 2.5), rest(0), rest(np.pi), objective=rt.Effort())
    return phase, rt.guess.StraightLine(duration=1)


def two_link_arm() -> tuple[rt.Phase, rt.guess.StraightLine]:
    phase = rt.Phase(rt.load("two_link_arm"), (1, 10), rest(0, 0.5), rest(0.522, 0.5), objective=rt.Duration())
    return phase, rt.guess.StraightLine(duration=3)


ROBOTS = {
    "double_integrator": block,
    "cartpole": cartpole,
    "acrobot": acrobot,
    "pendulum": pendulum,
    "two_link_arm": two_link_arm,
}


def table() -> list[Any]:
    return [
        pytest.param(name, scheme, intervals, value, id=f"{name}-{scheme}-{intervals}")
        for name in ROBOTS
        for scheme, values in TABLE[name]["mesh"].items()
        for intervals, value in values.items()
    ]


@pytest.mark.parametrize(("name", "scheme", "intervals", "value"), table())
def test_optimum_of_the_robot_is_the_tables(name: str, scheme: str, intervals: int, value: float) -> None:
    phase, guess = ROBOTS[name]()
    solution = rt.plan(phase, rt.Mesh(intervals, SCHEMES[scheme]), guess)
    assert solution.success
    assert solution.objective == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize("name", ["double_integrator", "cartpole", "pendulum"])
def test_the_default_guess_finds_the_exact_optimum(name: str) -> None:
    phase, _ = ROBOTS[name]()
    assert rt.plan(phase, rt.Mesh()).objective == pytest.approx(TABLE[name]["exact"], rel=2e-6)
