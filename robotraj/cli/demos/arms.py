"""Demos of arms."""

from __future__ import annotations

from robotraj.cli.demos.demo import Demo
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.phase import Phase
from robotraj.problem.state import State
from robotraj.robot.load import load
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh


def ur5() -> Demo:
    """Move a ur5 in 1 s within all limits of its URDF, forearm and wrist at least 5 cm above the ground."""
    move = Phase(
        load("ur5"),
        duration=1.0,
        start=State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0),
        end=State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0),
        objective=Effort(),
        constraints=[GroundClearance(["forearm_link", "wrist_1_link", "tool0"], 0.05)],
        name="pick to place",
    )
    return Demo(move, (Mesh(50, HermiteSimpson()),))
