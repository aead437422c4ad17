"""Demos of one or two joints that plan within seconds."""

from __future__ import annotations

import numpy as np

from robotraj.cli.demos.demo import Demo
from robotraj.guess.keyframes import Keyframes
from robotraj.indirect.necessary_conditions import conditions
from robotraj.indirect.polishing import polish
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.phase import Phase
from robotraj.problem.state import State
from robotraj.robot.load import load
from robotraj.solution.solution import Solution
from robotraj.transcription.schemes.control import ConstantControl
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh


def block() -> Demo:
    """Push a block of 1 kg over 10 m with at most 1 N, in minimum time: full ahead, full back."""
    move = Phase(
        load("block"),
        duration=(0.1, 200.0),
        start=State(q=0, v=0),
        end=State(q=10, v=0),
        objective=Duration(),
        name="minimum time",
    )
    # One force per interval: a polynomial would overshoot its limit between the points at the switch.
    return Demo(move, (Mesh(50, HermiteSimpson(control=ConstantControl())),))


def pendulum() -> Demo:
    """Swing a pendulum up with a motor that is too weak to lift it."""
    robot = load("pendulum")
    swing_up = Phase(
        robot,
        duration=(2.0, 20.0),
        start=State(q=0, v=0),
        end=State(q=np.pi, v=0),
        objective=Duration() + 0.1 * Effort(),
        limits=robot.limits.with_(effort=0.5),
        name="swing-up with a weak motor",
    )
    return Demo(swing_up)


def cartpole() -> Demo:
    """Swing a pole up by pushing its cart 1 m aside in 2 s, with least effort (Kelly, SIAM Review, 2017)."""
    swing_up = Phase(
        load("cartpole"),
        duration=2.0,
        start=State(q=[0, 0], v=0),
        end=State(q=[1, np.pi], v=0),
        objective=Effort(),
        name="swing-up",
    )
    return Demo(swing_up)


def multistart() -> Demo:
    """Plan the cart-pole from 20 random guesses and keep the best of the local optima."""
    return Demo(cartpole().problem, (Mesh(40),), starts=20)


def costates() -> Demo:
    """Check Pontryagin's conditions of the block's motion in minimum time, and polish it to round-off."""

    def analysis(solution: Solution) -> str:
        return f"{conditions(solution)}\n\n{polish(solution)}"

    return Demo(block().problem, (Mesh(10),), tolerance=1e-6, analysis=analysis)


def acrobot() -> Demo:
    """Swing a double pendulum up by its elbow alone; keyframes decide which way it goes."""
    swing_up = Phase(
        load("acrobot"),
        duration=2.0,
        start=State(q=[0, 0], v=0),
        end=State(q=[np.pi, 0], v=0),
        objective=Effort(),
        name="swing-up",
    )
    half = np.pi / 2
    poses: list[list[float]] = [[0, 0], [-half, half], [half, half], [np.pi, 0]]
    return Demo(swing_up, guess=Keyframes([0, 0.25, 0.75, 1], [State(q=pose, v=0) for pose in poses]))
