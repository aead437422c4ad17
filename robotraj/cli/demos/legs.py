"""Demos of robots with legs in space: Solo12, Bolt, and the legs of Talos.

The URDFs of Solo12 and Bolt give 10 rad, 1000 rad/s and 1000 N m for every joint; their motors give 2.7 N m. Those of
Talos hold as they are.
"""

from __future__ import annotations

from functools import partial

import casadi as ca

from robotraj.cli.demos.demo import Demo
from robotraj.dynamics.contacts.cones import Linearised
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.gait import gait_objective, jump, stand, trot, walk
from robotraj.problem.links.periodic import Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.expressions import Lagrange
from robotraj.problem.phase import Phase
from robotraj.problem.state import State
from robotraj.robot.load import load
from robotraj.robot.robot import Robot
from robotraj.transcription.schemes.lobatto import HermiteSimpson, LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh


def _small(name: str) -> Robot:
    return load(name, root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})


def _calm(weight: float) -> Objective:
    """Weigh the joints' accelerations, which makes swings smooth."""
    return weight * Lagrange(lambda point: ca.sumsqr(point.a[6:]))


def solo12_trot() -> Demo:
    """Trot at 0.3 m/s; half a stride closes on its own mirror image."""
    robot, foot = _small("solo12"), partial(PointContact, friction=0.5)
    cost = gait_objective(robot, stand(robot, contact=foot)) + _calm(1e-5)
    stride = trot(robot, step_length=0.06, duration=0.2, clearance=0.04, contact=foot, objective=cost)
    return Demo(stride, periods=4)


def solo12_jump() -> Demo:
    """Jump 10 cm forward and 8 cm up."""
    robot, foot = _small("solo12"), partial(PointContact, friction=0.5)
    cost = gait_objective(robot, stand(robot, contact=foot)) + _calm(1e-4)
    # Feet keep a small load when they push off and land, since the cone is not smooth at zero force.
    loaded = partial(foot, cone=Linearised(4), normal_force=(0.5, 40.0))
    leap = jump(robot, length=0.1, height=0.08, push=0.25, land=0.25, contact=loaded, objective=cost)
    return Demo(leap, ([Mesh(n, HermiteSimpson()) for n in (18, 12, 14)],))


def bolt_walking() -> Demo:
    """Walk on two points; Bolt never stands still."""
    feet, foot = ("FL_FOOT", "FR_FOOT"), partial(PointContact, friction=0.6)
    robot = _small("bolt")
    cost = gait_objective(robot, stand(robot, feet, foot)) + _calm(1e-5)
    step = walk(robot, feet=feet, contact=foot, step_length=0.06, duration=0.2, clearance=0.03, objective=cost)
    return Demo(step, (Mesh(6, LobattoIIIA(4)),), periods=6)


def talos_walking() -> Demo:
    """Walk on flat feet, with both of them down between the steps."""
    sole = partial(FlatFoot, length=0.2, width=0.12, friction=0.6)
    feet = ("left_sole_link", "right_sole_link")
    robot = load("talos_legs", root="floating")
    cost = gait_objective(robot, stand(robot, feet, sole)) + _calm(0.3)
    pace = partial(walk, step_length=0.2, duration=0.8, clearance=0.04, double_support=0.2)
    # Both steps are planned, since the inertias of its legs are not symmetric.
    steps = pace(robot, feet=feet, contact=sole, objective=cost, repeat=Periodic())
    return Demo(steps, periods=3)


def humanoid_stands_up() -> Demo:
    """Stand up with 29 joints, arms included, from the built-in guess."""
    robot, feet = load("g1", root="floating"), ("left_ankle_roll_link", "right_ankle_roll_link")
    sole = partial(FlatFoot, length=0.15, width=0.05, offset=(0.03, 0, -0.03))
    crouched, upright = (stand(robot, feet, sole, height=height) for height in (0.55, 0.64))
    rise = Phase(
        robot,
        duration=1.2,
        start=State(q=crouched, v=0),
        end=State(q=upright, v=0),
        objective=gait_objective(robot, upright),
        contacts=[sole(foot) for foot in feet],
        name="stand up",
    )
    return Demo(rise)
