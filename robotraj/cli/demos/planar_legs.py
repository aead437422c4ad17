"""Demos of bipeds in the plane: a compass, and five links walking, running and on stairs."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj.cli.demos.demo import Demo
from robotraj.dynamics.contacts.implicit import ImplicitContact
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.terrain.slope import Slope
from robotraj.dynamics.terrain.steps import Steps
from robotraj.gait import GaitTerms, Support, run, sequence, stand, walk
from robotraj.planning.continuation import tightening
from robotraj.problem.constraints.base import AtEnd
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.links.periodic import Mirror
from robotraj.problem.links.touchdown import Touchdown
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.load import load
from robotraj.transcription.schemes.control import LinearControl
from robotraj.transcription.schemes.lobatto import HermiteSimpson, LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.radau import RadauIIA

DESCENT = 0.0525
"""Angle [rad] of the slope that the compass walks down."""


def compass_walker() -> Demo:
    """Walk down a slope without any torque: the gait closes on its own mirror image."""
    ground = Slope(-np.tan(DESCENT))

    def height(point: RobotPoint) -> ca.SX:
        foot = point.frame("right_foot").position
        return foot[2] - ground.height(foot[0], foot[1])

    motor = PathConstraint(lambda point: point.tau[0] + point.tau[1], 0, 0, name="one motor", unit="N m")
    step = Phase(
        load("compass_walker", root="planar"),
        duration=(0.6, 1.2),
        start=State(q={"root_pitch": 0}),
        contacts=[PointContact("left_foot", ground=ground)],
        parameters={"left_foot.x": 0},
        constraints=[motor, AtEnd(PathConstraint(height, 0, 0, name="foot on the ground"))],
        objective=Effort(),
        name="downhill",
    )
    legs = {"left_hip": "right_hip", "left_foot": "right_foot"}
    mirror = Mirror(legs, displacement={"q.root_x": between(0.3, 0.8), "q.root_z": None})
    gait = Problem([step], [Touchdown(0, 0, repeat=mirror)])
    return Demo(gait, (Mesh(8, LobattoIIIA(4)),), tolerance=1e-6, periods=6)


def hopper() -> Demo:
    """Hop half a metre forward; the solver finds when the foot stands, slips or flies.

    The plan is not proved: an impact lasts one interval in it, which the simulation of a short part does not reproduce.
    """
    still = {"root_z": 0.5, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
    hop = Phase(
        load("hopper", root="planar"),
        duration=1.0,
        contacts=[ImplicitContact("foot", friction=0.8, relaxation=1e-4)],
        start=State(q=still | {"root_x": 0.0}, v=0),
        end=State(q=still | {"root_x": 0.5}, v=0),
        objective=Effort({"hip": 1.0, "leg": 0.01}),
        name="hop",
    )
    # First the ground pushes from a distance. Tightened in small steps, the hops hardly depend on round-off.
    steps = tightening(hop, np.geomspace(30.0, 1e-3, 10).tolist())
    # An impact is a force that lasts one interval: every interval has one collocation point, at its end.
    return Demo(hop, (Mesh(40, RadauIIA(1)),), continuation=steps)


def five_link_walking() -> Demo:
    """Walk with least effort in steps of 0.5 m and 0.7 s (Kelly, SIAM Review, 2017)."""
    contact = PointContact("left_foot", friction=2.0)
    robot = load("five_link", root="planar")
    step = walk(robot, step_length=0.5, duration=0.7, contact=contact, clearance=0.1, upright=None)
    return Demo(step, (Mesh(20, LobattoIIIA(4)),), periods=6)


def five_link_running() -> Demo:
    """Run at 2.5 m/s: stance, flight, and a landing on the other foot."""
    contact = PointContact("left_foot", friction=0.8)
    written = run(load("five_link", root="planar"), step_length=1.0, duration=0.4, contact=contact)
    scheme = HermiteSimpson(control=LinearControl())
    return Demo(written, (Mesh(10, scheme),), tolerance=1e-5, periods=6)


def five_link_stairs() -> Demo:
    """Climb two stairs, from standing on both feet to standing on both feet."""
    robot = load("five_link", root="planar")
    stairs = Steps.stairs(start=0.2, run=0.4, rise=0.1, count=2)
    foot = PointContact("left_foot", friction=0.8, ground=stairs)
    left, right = "left_foot", "right_foot"
    first, second = between(0.25, 0.5), between(0.65, 1.0)
    supports = [
        Support((left, right), 0.3, "lean forward"),
        Support((left,), (0.4, 0.7), "right foot to the first stair"),
        Support((right,), (0.4, 0.7), "left foot to the second"),
        Support((left,), (0.4, 0.7), "right foot beside it"),
        Support((left, right), 0.3, "come to rest"),
    ]
    footholds = [
        {},
        {},
        {"right_foot.x": first},
        {"left_foot.x": second},
        {"left_foot.x": second, "right_foot.x": second},
    ]
    terms = GaitTerms(foot, clearance=0.0, objective=Effort(), ground=stairs)
    written = sequence(robot, supports, terms, None, State(q=stand(robot), v=0), State(v=0))
    phases = [replace(phase, parameters=where) for phase, where in zip(written.phases, footholds, strict=True)]
    return Demo(Problem(phases, written.links), (Mesh(6), Mesh(12, LobattoIIIA(5))))
