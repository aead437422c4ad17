"""Demos of systems written with CasADi."""

from __future__ import annotations

from robotraj.cli.demos.demo import Demo
from robotraj.dynamics.system import System
from robotraj.problem.constraints.bounds import between
from robotraj.problem.links.continuity import Jump
from robotraj.problem.links.linkage import Linkage
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.shooting import MultipleShooting


def _mass() -> System:
    return System(states=["x", "v"], controls=["F"], dynamics=lambda point: [point.x["v"], point.u["F"]])


def lecture() -> Demo:
    """Move a mass of 1 kg over 10 m in minimum time by multiple shooting on 20 segments."""
    move = Phase(
        _mass(),
        duration=(0.1, 200.0),
        start=State([0, 0]),
        end=State([10, 0]),
        objective=Duration(),
        controls={"F": between(-1, 1)},
        name="minimum time",
    )
    return Demo(move, (Mesh(20, MultipleShooting()),))


def bouncing_mass() -> Demo:
    """Throw a mass against a wall, from which it returns with 80 % of its speed, with least effort."""
    wall = State({"x": 0.5, "v": between(1, None)})
    to, back = (
        Phase(_mass(), (0.01, 2.0), start, end, Effort(), controls={"F": between(-20, 20)}, name=name)
        for name, start, end in (("to the wall", State([0, 0]), wall), ("and back", State({"x": 0.5}), State([0, 0])))
    )
    rebound = Linkage((0, 1), lambda a, b: b.start.x["v"] + 0.8 * a.end.x["v"], name="restitution", unit="m/s")
    return Demo(Problem([to, back], [Jump(0, 1, jumps={"v": None}), rebound]), (Mesh(20),))
