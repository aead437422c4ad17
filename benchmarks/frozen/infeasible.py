"""Drawn problems without a solution, each with the row that conflicts."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
from arms import SMOOTH, TOOLS, arm, configurations
from drawn import Drawn

import robotraj as rt


def infeasible(draw: np.random.Generator, number: int) -> Drawn:
    """Break one limit of an arm or a mass that no motion meets."""
    return (_too_fast, _too_weak, _too_far, _too_slow, _heavy_push, _short_zones)[number % 6](draw, number)


def _too_fast(draw: np.random.Generator, number: int) -> Drawn:
    """Give less time than the speed limits need."""
    robot = arm(SMOOTH[number // 6 % 6])
    first, last = configurations(robot, draw, 2)
    times = np.abs(last - first) / robot.limits.velocity
    phase = partial(
        rt.Phase,
        robot,
        float(draw.uniform(0.4, 0.8) * times.max()),
        rt.State(q=first, v=0),
        rt.State(q=last, v=0),
        rt.Effort(),
    )
    return Drawn(phase, names=(robot.joint_names[int(np.argmax(times))], "velocity"))


def _too_weak(draw: np.random.Generator, number: int) -> Drawn:
    """Give the joint with the largest torque at the end less than it needs there."""
    robot = arm(SMOOTH[number // 6 % 6])
    data = robot.model.createData()
    for _ in range(1000):
        first, last = configurations(robot, draw, 2)
        held = np.abs(pin.computeGeneralizedGravity(robot.model, data, last))
        joint = int(np.argmax(held))
        if held[joint] > 2.0:
            break
    weak = {robot.joint_names[joint]: float(draw.uniform(0.3, 0.8) * held[joint])}
    phase = partial(
        rt.Phase,
        robot,
        3.0,
        rt.State(q=first, v=0),
        rt.State(q=last, v=0),
        rt.Effort(),
        limits=robot.limits.with_(effort=weak),
    )
    return Drawn(phase, names=(robot.joint_names[joint], "effort|N m"))


def _too_far(draw: np.random.Generator, number: int) -> Drawn:
    """Move the tool to a place that is out of reach."""
    name = SMOOTH[number // 6 % 6]
    robot = arm(name)
    (first,) = configurations(robot, draw, 1)
    way = draw.normal(size=3)
    place = (float(draw.uniform(1.8, 2.5)) * way / np.linalg.norm(way)).tolist()
    rows = [rt.AtEnd(rt.FramePosition(TOOLS[name], place))]
    phase = partial(rt.Phase, robot, 3.0, rt.State(q=first, v=0), rt.State(v=0), rt.Effort(), rows)
    return Drawn(phase, names=("frame position", TOOLS[name]))


def _too_slow(draw: np.random.Generator, number: int) -> Drawn:
    """Limit accelerations below what the time needs."""
    robot = arm(SMOOTH[number // 6 % 6])
    first, last = configurations(robot, draw, 2)
    needed = 4.0 * np.abs(last - first) / 9.0
    limits = robot.limits.with_(acceleration=float(draw.uniform(0.3, 0.8) * needed.max()))
    phase = partial(rt.Phase, robot, 3.0, rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Effort(), limits=limits)
    return Drawn(phase, names=(robot.joint_names[int(np.argmax(needed))], "acceleration"))


def _heavy_push(draw: np.random.Generator, number: int) -> Drawn:
    """Push a mass further than its force allows in the time."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], name="block")
    time = float(draw.uniform(1, 4))
    way = float(draw.uniform(1.2, 2.0)) * time**2 / 4.0
    phase = partial(
        rt.Phase, system, time, rt.State([0, 0]), rt.State([way, 0]), rt.Effort(), controls={"u": rt.between(-1, 1)}
    )
    return Drawn(phase, names=("u",))


def _short_zones(draw: np.random.Generator, number: int) -> Drawn:
    """Cross two zones in less time than their speed limit allows."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], name="block")
    speed = float(draw.uniform(0.5, 2.0))
    way = float(draw.uniform(1.2, 2.0)) * 2.0 * speed
    bounds = {"v": rt.between(-speed, speed)}
    go = rt.Phase(system, 1.0, rt.State([0, 0]), None, rt.Effort(), states=bounds, name="go")
    on = rt.Phase(system, 1.0, None, rt.State([way, 0]), rt.Effort(), states=bounds, name="on")
    return Drawn(rt.Problem([go, on], [rt.Continuity(0, 1)]), names=("v", "state bound|duration"))
