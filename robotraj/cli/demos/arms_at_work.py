"""Demos of arms that carry, reach into shelves and draw."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.cli.demos.demo import Demo
from robotraj.planning.paths.joint_path import as_path
from robotraj.problem.constraints.follow_path import FollowPath

HOME = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])


def pick_and_place() -> Demo:
    """Carry a payload past a post: three phases in minimum time."""
    ur5 = rt.load("ur5")
    load = rt.robot.CarriedBody("tool0", mass=2.0, center_of_mass=(0, 0, 0.06), inertia=(0.004, 0.004, 0.004))
    post = rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47), name="post")
    carried = rt.obstacles.Box((0.08, 0.08, 0.08), position=(0, 0, 0.06), frame="tool0", name="load")
    rest = rt.State(q=[-1.6, -1.6, 1.2, -1.2, -1.57, 0.0], v=0)
    pick = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], v=0)
    place = rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
    clear = rt.CollisionFree([post], margin=0.01, self_collision=False)
    loaded = rt.CollisionFree([post, carried], margin=0.01, self_collision=False)
    reach = rt.Phase(ur5, (0.1, 5), rest, pick, rt.Duration(), [clear], name="reach")
    carry = rt.Phase(rt.robot.carrying(ur5, load), (0.1, 5), pick, place, rt.Duration(), [loaded], name="carry")
    retreat = rt.Phase(ur5, (0.1, 5), place, rest, rt.Duration(), [clear], name="return")
    return Demo(rt.Problem([reach, carry, retreat], [rt.Continuity(0, 1), rt.Continuity(1, 2)]))


def shelf_to_shelf() -> Demo:
    """Move a hand from one shelf to the next around the board between them."""
    panda = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    heights = {"bottom": 0.2, "middle": 0.55, "top": 0.9}
    boards = [
        rt.obstacles.Box((0.3, 0.9, 0.03), position=(0.7, 0.0, z), name=f"{name} board") for name, z in heights.items()
    ]
    ahead = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    lower, upper = (pin.SE3(ahead, np.array(at)) for at in ([0.52, 0.2, 0.38], [0.52, -0.2, 0.74]))
    move = rt.Phase(
        panda,
        duration=(0.2, 5.0),
        start=rt.State(v=0),
        end=rt.State(v=0),
        objective=rt.Duration(),
        constraints=[
            rt.AtStart(rt.FramePose("panda_hand", lower)),
            rt.AtEnd(rt.FramePose("panda_hand", upper)),
            rt.CollisionFree(boards, margin=0.01),
        ],
        name="shelf to shelf",
    )
    return Demo(move)


def glass_of_water() -> Demo:
    """Carry a glass whose axis stays within half a degree of the vertical."""
    ur5 = rt.load("ur5")
    first = _placed(ur5, HOME)
    upright = rt.constraints.FrameAxis("tool0", axis=first.rotation.T @ [0, 0, 1], angle=np.deg2rad(0.5))
    table = rt.AtEnd(rt.FramePosition("tool0", first.translation + [-0.1, 0.45, 0.1]))
    ends, gentle = (rt.State(q=HOME, v=0), rt.State(v=0)), ur5.limits.with_(velocity=1.5, acceleration=5.0)
    return Demo(rt.Phase(ur5, (0.1, 5), *ends, rt.Duration(), [upright, table], limits=gentle, name="a glass of water"))


def drawn_path() -> Demo:
    """Follow an eight of the tool in minimum time; inverse kinematics gives the path of the joints."""
    ur5 = rt.load("ur5")
    data, tool, first = ur5.model.createData(), ur5.frame("tool0"), _placed(ur5, HOME)
    drawn, q = [], HOME
    for s in np.linspace(0, 2 * np.pi, 41):
        target = pin.SE3(first.rotation, first.translation + [0.08 * np.sin(2 * s), 0.2 * np.sin(s), 0.0])
        for _ in range(10):
            pin.framesForwardKinematics(ur5.model, data, q)
            jacobian = pin.computeFrameJacobian(ur5.model, data, q, tool)
            q = q + np.linalg.solve(jacobian, pin.log(data.oMf[tool].actInv(target)).vector)
        drawn.append(q)
    follow = FollowPath(as_path(np.array(drawn), None))
    limits = ur5.limits.with_(position=np.inf)
    return Demo(
        rt.Phase(ur5, (0.0, 60.0), objective=rt.Duration(), constraints=[follow], limits=limits, name="drawn path")
    )


def _placed(robot: rt.Robot, q: np.ndarray) -> pin.SE3:
    """Return the placement of the tool at q."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame("tool0")].copy()
