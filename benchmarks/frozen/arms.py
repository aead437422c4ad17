"""Drawn motions of arms with 6 and 7 joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
from drawn import Drawn

import robotraj as rt
from robotraj._util.arrays import Array

TOOLS = {
    "ur3": "tool0",
    "ur5": "tool0",
    "ur10": "tool0",
    "kinova": "j2s6s200_end_effector",
    "panda": "panda_hand_tcp",
    "xarm7": "link_eef",
    "z1": "gripperMover",
}
"""Arms and the frames of their tools."""
LOCKED = {"panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}, "z1": {"jointGripper": 0.0}}
FREE = (0.1, 20.0)
"""Bounds of a free duration [s]."""
SMOOTH = ("ur3", "ur5", "ur10", "kinova", "panda", "xarm7")
"""Arms without dry friction in their URDF."""


def arm(name: str) -> rt.Robot:
    """Load an arm without its fingers."""
    return rt.load(name, locked=LOCKED.get(name))


def configurations(robot: rt.Robot, draw: np.random.Generator, count: int, step: float = 1.0) -> list[Array]:
    """Draw configurations within 90 % of the limits and 2.5 rad, each within a share ``step`` of them from the last."""
    low = 0.9 * np.maximum(robot.limits.position_lower, -2.5)
    high = 0.9 * np.minimum(robot.limits.position_upper, 2.5)
    low, high = np.minimum(low, high), np.maximum(low, high)
    found = [low + draw.random(robot.nq) * (high - low)]
    while len(found) < count:
        other = low + draw.random(robot.nq) * (high - low)
        found.append(found[-1] + step * (other - found[-1]))
    return found


def least_duration(robot: rt.Robot, first: Array, last: Array) -> float:
    """Return a bound on the duration by the limits of speed [s]; 3 rad/s where a joint has none."""
    speeds = np.minimum(np.where(robot.limits.velocity < 1e20, robot.limits.velocity, 3.0), 3.0)
    return float(np.max(np.abs(last - first) / speeds))


def between_rests(
    robot: rt.Robot, draw: np.random.Generator, objective: rt.objectives.Objective, timed: bool, **more: object
) -> rt.Phase:
    """Move between drawn configurations, in 1.5 to 3 times the least duration or in a free one."""
    first, last = configurations(robot, draw, 2)
    fixed = float(draw.uniform(1.5, 3.0)) * least_duration(robot, first, last)
    ends = rt.State(q=first, v=0), rt.State(q=last, v=0)
    return rt.Phase(robot, fixed if timed else FREE, *ends, objective, **more)


def effort(draw: np.random.Generator, number: int) -> Drawn:
    """Take the least effort in a given time."""
    return Drawn(between_rests(arm(SMOOTH[number % 6]), draw, rt.Effort(), timed=True))


def time(draw: np.random.Generator, number: int) -> Drawn:
    """Take the least time, every third motion with limits of acceleration."""
    robot = arm(SMOOTH[number % 6])
    limits = robot.limits.with_(acceleration=float(draw.uniform(4, 12))) if number % 3 == 2 else robot.limits
    return Drawn(between_rests(robot, draw, rt.Duration(), timed=False, limits=limits))


def work(draw: np.random.Generator, number: int) -> Drawn:
    """Take the least absolute power, alone or with a small effort."""
    weight = 10.0 ** draw.uniform(-4, -2) if number % 2 else 0.0
    objective = rt.objectives.AbsolutePower()
    return Drawn(
        between_rests(arm(SMOOTH[number % 6]), draw, objective + weight * rt.Effort() if weight else objective, True)
    )


def jerk(draw: np.random.Generator, number: int) -> Drawn:
    """Take the least jerk, and least time or effort under limits of jerk."""
    robot = arm(SMOOTH[number % 6])
    if number % 3 == 0:
        return Drawn(between_rests(robot, draw, rt.objectives.Jerk(), timed=True))
    limit = float(10.0 ** draw.uniform(1.5, 3.0))
    rows = [rt.constraints.JointJerk(rt.between(-limit, limit))]
    objective = rt.Duration() if number % 3 == 1 else rt.Effort()
    return Drawn(between_rests(robot, draw, objective, timed=number % 3 == 2, constraints=rows))


def mixture(draw: np.random.Generator, number: int) -> Drawn:
    """Minimise sums of time, effort, work and jerk with drawn weights; every fourth one to a tolerance."""
    weight = float(10.0 ** draw.uniform(-5, -1))
    terms = (
        rt.Duration() + weight * rt.Effort(),
        rt.Effort() + weight * rt.objectives.AbsolutePower(),
        rt.Effort() + weight * rt.objectives.Jerk(),
        rt.Duration() + weight * rt.Effort(),
    )
    timed = number % 4 in (1, 2)
    options = {"tolerance": 1e-4} if number % 4 == 3 else {}
    return Drawn(between_rests(arm(SMOOTH[number % 6]), draw, terms[number % 4], timed), options)


def friction(draw: np.random.Generator, number: int) -> Drawn:
    """Move against dry friction of up to a tenth of the effort limits, or that of a URDF."""
    robot = arm(("z1", "ur5", "panda", "ur10")[number % 4])
    if number % 4:
        robot = replace(robot, friction=float(10.0 ** draw.uniform(-3, -1)) * robot.limits.effort)
    kinds = (rt.Effort(), rt.Duration(), rt.Duration() + 1e-3 * rt.Effort(), rt.objectives.AbsolutePower())
    kind = number // 4 % 4
    return Drawn(between_rests(robot, draw, kinds[kind], timed=kind in (0, 3)))


def payload(draw: np.random.Generator, number: int) -> Drawn:
    """Carry a load of 0.2 to 1 kg at the tool."""
    name = SMOOTH[number % 6]
    load = rt.robot.CarriedBody(TOOLS[name], float(draw.uniform(0.2, 1.0)), tuple(draw.uniform(-0.05, 0.05, 3)))
    objective = (rt.Effort(), rt.Duration(), rt.Duration() + 1e-3 * rt.Effort())[number % 3]
    return Drawn(between_rests(rt.robot.carrying(arm(name), load), draw, objective, timed=number % 3 == 0))


def obstacles(draw: np.random.Generator, number: int) -> Drawn:
    """Pass one to three balls and boxes near the way of the tool, clear of every joint at both ends."""
    robot = arm(("ur5", "panda", "ur10", "xarm7")[number % 4])
    data = robot.model.createData()

    def places(q: Array) -> Array:
        pin.framesForwardKinematics(robot.model, data, q)
        return np.array([pose.translation for pose in data.oMf])

    first, last = configurations(robot, draw, 2, step=0.5)
    ends, shapes = np.vstack([places(first), places(last)]), []
    for _ in range(1000):
        at = places(first + draw.uniform(0.2, 0.8) * (last - first))[-1] + draw.normal(0, 0.1, 3)
        size = float(draw.uniform(0.04, 0.12))
        if np.min(np.linalg.norm(ends - at, axis=1)) > 2.0 * size + 0.2 and np.linalg.norm(at[:2]) > size + 0.25:
            box = rt.obstacles.Box((2 * size, size, 2 * size), position=at.tolist())
            shapes.append(box if draw.integers(2) else rt.obstacles.Sphere(size, position=at.tolist()))
        if len(shapes) > number % 3:
            break
    free = rt.CollisionFree(shapes, margin=0.01, self_collision=False)
    fixed = 3.0 * least_duration(robot, first, last)
    rests, timed = (rt.State(q=first, v=0), rt.State(q=last, v=0)), number % 2 == 1
    objective = rt.Effort() if timed else rt.Duration()
    return Drawn(rt.Phase(robot, fixed if timed else FREE, *rests, objective, [free]))


def path(draw: np.random.Generator, number: int) -> Drawn:
    """Take the least time along a spline through drawn configurations, every third one under limits of jerk."""
    robot = arm(SMOOTH[number % 6])
    count = int(draw.integers(4, 9))
    curve = rt.applications.as_path(np.array(configurations(robot, draw, count, step=0.3)))
    rows: list[rt.constraints.Constraint] = [rt.constraints.FollowPath(curve)]
    if number % 3 == 2:
        limit = float(10.0 ** draw.uniform(2, 3))
        rows.append(rt.constraints.JointJerk(rt.between(-limit, limit)))
    limits = robot.limits.with_(position=np.inf)
    return Drawn(rt.Phase(robot, (0.0, 1e3), objective=rt.Duration(), constraints=rows, limits=limits, name="path"))


def waypoints(draw: np.random.Generator, number: int) -> Drawn:
    """Pass one to three configurations without a stop; every fourth motion is cyclic."""
    robot = arm(SMOOTH[number % 6])
    places = configurations(robot, draw, 3 + number % 3, step=0.4)
    objective = rt.Duration() if number % 2 else rt.Duration() + 1e-3 * rt.Effort()
    return Drawn(rt.Waypoints(robot, places, cyclic=number % 4 == 3, objective=objective))
