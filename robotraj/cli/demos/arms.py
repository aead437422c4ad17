"""Demos of arms."""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj.cli.demos.demo import Demo
from robotraj.dynamics.design.length import LinkLength
from robotraj.dynamics.design.mass import BodyMass
from robotraj.dynamics.obstacles.shapes import Box
from robotraj.guess.keyframes import Keyframes
from robotraj.problem.constraints.base import AtEnd, AtStart
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.constraints.frame_pose import FramePosition
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.objectives.expressions import Lagrange
from robotraj.problem.phase import Phase
from robotraj.problem.state import State
from robotraj.robot.join import join
from robotraj.robot.load import load
from robotraj.transcription.interval_limits.methods import BernsteinBounds
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
    return Demo(move)


def moving_goal() -> Demo:
    """Follow a goal of the joints that moves, from rest to rest."""
    still, sway = (1.1, -0.8, 0.6, -0.6, -0.6, 1.2), (0.3, -0.15, 0.15, 0.0, 0.0, 0.3)
    gap = Lagrange(
        lambda point: sum((point.q[i] - still[i] - sway[i] * ca.sin(2.0 * point.t)) ** 2 for i in range(len(still)))
    )
    follow = Phase(
        load("ur5"),
        duration=2.0,
        start=State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0),
        end=State(v=0),
        objective=gap + 1e-4 * Effort(),
        name="follow",
    )
    return Demo(follow, (Mesh(40, HermiteSimpson()),))


def design() -> Demo:
    """Plan an arm and its motion together: the lengths of its links, the mass of its upper arm, and the torques."""
    arm = load("two_link_arm")
    rod = PathConstraint(lambda point: point.p["mass"] - point.p["upper"], 0, 0, name="rod of 1 kg/m", unit="kg")
    carry = Phase(
        arm,
        duration=1.5,
        start=State(v=0),
        end=State(v=0),
        objective=Effort(),
        constraints=[
            AtStart(FramePosition("tip", {"x": 1.1, "y": -0.5})),
            AtEnd(FramePosition("tip", {"x": 0.6, "y": 1.2})),
            AtStart(rod),
        ],
        limits=arm.limits.with_(effort=20.0, velocity=10.0),
        parameters={"upper": between(0.3, 1.5), "mass": between(0.3, 1.5), "fore": between(0.3, 1.5)},
        design={
            "upper": LinkLength("shoulder", along=(1, 0, 0)),
            "mass": BodyMass("upper_arm"),
            "fore": LinkLength("elbow"),
        },
        name="carry",
    )
    bent = Keyframes([0, 1], [State(q=[0.5, -1.8], v=0), State(q=[1.9, -1.7], v=0)])
    return Demo(carry, (Mesh(60),), bent)


def tool_on_a_line() -> Demo:
    """Draw a straight line in minimum time with the tool pointing down."""
    down = PathConstraint(lambda point: point.frame("tool0").rotation[:2, 2], 0, 0, name="tool points down")
    draw = Phase(
        load("ur5"),
        duration=(0.2, 3.0),
        start=State(v=0),
        end=State(v=0),
        objective=Duration(),
        constraints=[
            FramePosition("tool0", {"x": 0.45, "z": 0.1}),
            down,
            AtStart(FramePosition("tool0", {"y": 0.3})),
            AtEnd(FramePosition("tool0", {"y": -0.3})),
        ],
        name="a line in least time",
    )
    about = [State(q=[pan, -1.2, 1.6, -2.0, -1.57, 0.0]) for pan in (0.3, -0.8)]
    everywhere = BernsteinBounds(controls=True)
    return Demo(draw, (Mesh(40),), Keyframes([0, 1], about), interval_limits=everywhere)


def around_a_box() -> Demo:
    """Pass a post in minimum time, proved between the points."""
    post = Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47), name="post")
    around = Phase(
        load("ur5"),
        duration=(0.2, 5.0),
        start=State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], v=0),
        end=State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0),
        objective=Duration(),
        constraints=[CollisionFree([post], margin=0.01, self_collision=False)],
        name="around a post",
    )
    return Demo(around)


def two_arms() -> Demo:
    """Two arms face each other and swap sides without touching."""
    arm, ahead = load("ur5"), np.array([0.0, -1.2, 1.4, -1.7, -1.57, 0.0])
    aside = np.array([1.2, 0.0, 0.0, 0.0, 0.0, 0.0])
    swap = Phase(
        join({"left": arm, "right": arm}, at={"right": ((0.9, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))}),
        duration=(0.2, 10.0),
        start=State(q=np.append(ahead + aside, ahead - aside), v=0),
        end=State(q=np.append(ahead - aside, ahead + aside), v=0),
        objective=Duration(),
        constraints=[CollisionFree()],
        name="swap sides",
    )
    return Demo(swap)
