"""Demos of arms that carry, reach into shelves and draw."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj.applications.paths.joint_path import as_path
from robotraj.cli.demos.demo import Demo
from robotraj.dynamics.obstacles.shapes import Box
from robotraj.problem.constraints.base import AtEnd, AtStart
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.constraints.frame_pose import FramePose, FramePosition
from robotraj.problem.constraints.task_space.axis import FrameAxis
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.carried_body import CarriedBody, carrying
from robotraj.robot.load import load
from robotraj.robot.robot import Robot

HOME = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])


def pick_and_place() -> Demo:
    """Carry a payload past a post: three phases in minimum time."""
    ur5 = load("ur5")
    payload = CarriedBody("tool0", mass=2.0, center_of_mass=(0, 0, 0.06), inertia=(0.004, 0.004, 0.004))
    post = Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47), name="post")
    carried = Box((0.08, 0.08, 0.08), position=(0, 0, 0.06), frame="tool0", name="load")
    rest = State(q=[-1.6, -1.6, 1.2, -1.2, -1.57, 0.0], v=0)
    pick = State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], v=0)
    place = State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
    clear = CollisionFree([post], margin=0.01, self_collision=False)
    loaded = CollisionFree([post, carried], margin=0.01, self_collision=False)
    reach = Phase(ur5, (0.1, 5), rest, pick, Duration(), [clear], name="reach")
    carry = Phase(carrying(ur5, payload), (0.1, 5), pick, place, Duration(), [loaded], name="carry")
    retreat = Phase(ur5, (0.1, 5), place, rest, Duration(), [clear], name="return")
    return Demo(Problem([reach, carry, retreat], [Continuity(0, 1), Continuity(1, 2)]))


def shelf_to_shelf() -> Demo:
    """Move a hand from one shelf to the next around the board between them."""
    panda = load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    heights = {"bottom": 0.2, "middle": 0.55, "top": 0.9}
    boards = [Box((0.3, 0.9, 0.03), position=(0.7, 0.0, z), name=f"{name} board") for name, z in heights.items()]
    ahead = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    lower, upper = (pin.SE3(ahead, np.array(at)) for at in ([0.52, 0.2, 0.38], [0.52, -0.2, 0.74]))
    move = Phase(
        panda,
        duration=(0.2, 5.0),
        start=State(v=0),
        end=State(v=0),
        objective=Duration(),
        constraints=[
            AtStart(FramePose("panda_hand", lower)),
            AtEnd(FramePose("panda_hand", upper)),
            CollisionFree(boards, margin=0.01),
        ],
        name="shelf to shelf",
    )
    return Demo(move)


def glass_of_water() -> Demo:
    """Carry a glass whose axis stays within half a degree of the vertical."""
    ur5 = load("ur5")
    first = _placed(ur5, HOME)
    upright = FrameAxis("tool0", axis=first.rotation.T @ [0, 0, 1], angle=np.deg2rad(0.5))
    table = AtEnd(FramePosition("tool0", first.translation + [-0.1, 0.45, 0.1]))
    ends, gentle = (State(q=HOME, v=0), State(v=0)), ur5.limits.with_(velocity=1.5, acceleration=5.0)
    return Demo(Phase(ur5, (0.1, 5), *ends, Duration(), [upright, table], limits=gentle, name="a glass of water"))


def drawn_path() -> Demo:
    """Follow an eight of the tool in minimum time; inverse kinematics gives the path of the joints."""
    ur5 = load("ur5")
    data, tool, first = ur5.model.createData(), ur5.frame("tool0"), _placed(ur5, HOME)
    drawn, q = [], HOME
    for s in np.linspace(0, 2 * np.pi, 41):
        target = pin.SE3(first.rotation, first.translation + [0.08 * np.sin(2 * s), 0.2 * np.sin(s), 0.0])
        for _ in range(10):
            pin.framesForwardKinematics(ur5.model, data, q)
            jacobian = pin.computeFrameJacobian(ur5.model, data, q, tool)
            q = q + np.linalg.solve(jacobian, pin.log(data.oMf[tool].actInv(target)).vector)
        drawn.append(q)
    follow = FollowPath(as_path(np.array(drawn)), 0.0, 0.0)
    free = ur5.limits.with_(position=np.inf)
    return Demo(Phase(ur5, (0.0, 1e3), objective=Duration(), constraints=[follow], limits=free, name="path"))


def _placed(robot: Robot, q: np.ndarray) -> pin.SE3:
    """Return the placement of the tool at q."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame("tool0")].copy()
