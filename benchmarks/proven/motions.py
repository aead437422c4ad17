"""Forty motions of the default call: arms, underactuated robots and steps of legged robots, without tuning."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import robotraj as rt

sys.path.insert(0, str(Path(__file__).parent))

from legs import step

ENDS = {
    "ur3": ([-1.1, -1.8, 1.6, -1.2, -1.57, 0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]),
    "ur5": ([-1.1, -1.8, 1.6, -1.2, -1.57, 0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]),
    "ur10": ([-1.1, -1.8, 1.6, -1.2, -1.57, 0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]),
    "kinova": ([0.0, 2.5, 1.5, 0.0, 2.0, 0.0], [1.2, 3.5, 2.5, 1.0, 1.2, 0.8]),
    "panda": ([0, -0.8, 0, -2.3, 0, 1.6, 0.8], [1.5, 0.4, -0.6, -1.2, 0.5, 2.2, -0.5]),
    "xarm7": ([0, -0.5, 0, 0.8, 0, 1.2, 0], [1.2, 0.3, -0.6, 1.6, 0.5, 0.6, 0.8]),
    "z1": ([0, 1.0, -1.0, 0.2, 0, 0], [1.2, 1.8, -1.6, -0.6, 0.8, 0.9]),
}
"""First and last positions of arms [rad]."""
LOCKED = {
    "panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0},
    "z1": {"jointGripper": 0.0},
}
MIXED = rt.Duration() + 1e-3 * rt.Effort()
FREE = (0.1, 20.0)


def arm(name: str, duration: float | tuple[float, float], objective: rt.objectives.Objective) -> rt.Phase:
    """Move an arm from rest to rest within the limits of its URDF."""
    start, end = ENDS[name]
    robot = rt.load(name, locked=LOCKED.get(name))
    return rt.Phase(robot, duration, rt.State(q=start, v=0), rt.State(q=end, v=0), objective, name=name)


def swing_up(name: str, end: list[float], duration: float | tuple[float, float], **more: object) -> rt.Phase:
    """Swing up from hanging to standing."""
    robot = rt.load(name)
    start, up = rt.State(q=np.zeros(robot.nq), v=0), rt.State(q=end, v=0)
    return rt.Phase(robot, duration, start, up, more.pop("objective", rt.Effort()), name=name, **more)


def weak_pendulum() -> rt.Phase:
    """Swing a pendulum up with a motor that cannot lift it."""
    weak = rt.load("pendulum").limits.with_(effort=0.5)
    return swing_up("pendulum", [np.pi], (2.0, 20.0), objective=rt.Duration() + 0.1 * rt.Effort(), limits=weak)


def five_link(speed: float) -> rt.Problem:
    """Walk in the plane in steps of 0.5 m."""
    robot = rt.load("five_link", root="planar")
    return rt.gait.walk(robot, step_length=0.5, duration=0.5 / speed, clearance=0.05)


MOTIONS: dict[str, Callable[[], rt.Phase | rt.Problem]] = {
    "ur5, effort, 1 s": partial(arm, "ur5", 1.0, rt.Effort()),
    "ur5, effort, 2 s": partial(arm, "ur5", 2.0, rt.Effort()),
    "ur5, time": partial(arm, "ur5", FREE, rt.Duration()),
    "ur5, time and effort": partial(arm, "ur5", FREE, MIXED),
    "ur5, jerk, 1.5 s": partial(arm, "ur5", 1.5, rt.objectives.Jerk()),
    "ur3, effort, 1.5 s": partial(arm, "ur3", 1.5, rt.Effort()),
    "ur3, time": partial(arm, "ur3", FREE, rt.Duration()),
    "ur10, effort, 1.5 s": partial(arm, "ur10", 1.5, rt.Effort()),
    "ur10, time": partial(arm, "ur10", FREE, rt.Duration()),
    "ur10, time and effort": partial(arm, "ur10", FREE, MIXED),
    "kinova, effort, 3 s": partial(arm, "kinova", 3.0, rt.Effort()),
    "kinova, time": partial(arm, "kinova", FREE, rt.Duration()),
    "panda, effort, 1 s": partial(arm, "panda", 1.0, rt.Effort()),
    "panda, effort, 2 s": partial(arm, "panda", 2.0, rt.Effort()),
    "panda, time": partial(arm, "panda", FREE, rt.Duration()),
    "panda, time and effort": partial(arm, "panda", FREE, MIXED),
    "panda, jerk, 1.5 s": partial(arm, "panda", 1.5, rt.objectives.Jerk()),
    "xarm7, effort, 1.5 s": partial(arm, "xarm7", 1.5, rt.Effort()),
    "xarm7, time": partial(arm, "xarm7", FREE, rt.Duration()),
    "z1 with friction, effort, 1.5 s": partial(arm, "z1", 1.5, rt.Effort()),
    "z1 with friction, effort, 3 s": partial(arm, "z1", 3.0, rt.Effort()),
    "z1 with friction, time": partial(arm, "z1", FREE, rt.Duration()),
    "z1 with friction, time and effort": partial(arm, "z1", FREE, MIXED),
    "pendulum, weak motor": weak_pendulum,
    "cartpole, 2 s": partial(swing_up, "cartpole", [1, np.pi], 2.0),
    "cartpole, time and effort": partial(
        swing_up, "cartpole", [1, np.pi], (0.5, 10.0), objective=rt.Duration() + 0.01 * rt.Effort()
    ),
    "acrobot, 2 s": partial(swing_up, "acrobot", [np.pi, 0], 2.0),
    "acrobot, 3 s": partial(swing_up, "acrobot", [np.pi, 0], 3.0),
    "five-link walk, 0.7 m/s": partial(five_link, 0.7),
    "five-link walk, 1 m/s": partial(five_link, 1.0),
    "solo12 trot, slow": partial(step, "solo12", 0.1),
    "solo12 trot, fast": partial(step, "solo12", 0.25),
    "go1 trot, both halves": partial(step, "go1", 0.1),
    "hyq trot": partial(step, "hyq", 0.1),
    "anymal trot, both halves": partial(step, "anymal", 0.1),
    "bolt walk, slow": partial(step, "bolt", 0.1),
    "bolt walk, fast": partial(step, "bolt", 0.25),
    "alexander walk, both halves": partial(step, "alexander", 0.1),
    "talos_legs walk, both halves": partial(step, "talos_legs", 0.1),
    "g1 walk, both halves": partial(step, "g1", 0.1),
}
"""Problems by name; each is written out when it is called."""
