"""Drawn motions of systems, of joints without motors, in several phases, and of legs."""

from __future__ import annotations

from functools import cache

import numpy as np
from arms import FREE, arm, configurations, least_duration
from cases import cases
from drawn import Drawn
from problems.case import Case
from proven.legs import step
from swing_ups import swing_up

import robotraj as rt

SWINGING = ("acrobot", "double pendulum", "cart-pole", "pendulum")
FLOATING = ("solo12", "go1", "bolt", "hyq", "anymal", "a1", "alexander")


@cache
def _systems() -> tuple[Case, ...]:
    """Cases that are written as equations."""
    return tuple(case for case in cases() if not case.name.endswith("URDF"))


def system(draw: np.random.Generator, number: int) -> Drawn:
    """Take a case with a reference optimum from its own guess: proved, or to a tolerance."""
    case = _systems()[number]
    options = {"guess": case.guess} | ({"tolerance": 1e-6} if number % 2 else {})
    return Drawn(case.problem, options)


def swinging(draw: np.random.Generator, number: int) -> Drawn:
    """Swing up with drawn torques in a drawn time."""
    return Drawn(swing_up(SWINGING[number % 4], draw))


def phases(draw: np.random.Generator, number: int) -> Drawn:
    """Bounce a mass, move it under speed limits that change, or let an arm take a load."""
    return Drawn((_bounce, _zones, _carry)[number % 3](draw))


def _mass() -> rt.System:
    return rt.System(["x", "v"], ["F"], lambda point: [point.x["v"], point.u["F"]], name="mass")


def _bounce(draw: np.random.Generator) -> rt.Problem:
    """Hit a wall and come back with a share of the speed."""
    share, limits = float(draw.uniform(0.4, 0.9)), {"controls": {"F": rt.between(-20, 20)}}
    objective = rt.Effort() + float(draw.uniform(0, 10)) * rt.Duration()
    wall = rt.State({"x": 0.5, "v": rt.between(float(draw.uniform(0.5, 1.5)), None)})
    go = rt.Phase(_mass(), (0.01, 2.0), rt.State([0, 0]), wall, objective, name="to the wall", **limits)
    back = rt.Phase(_mass(), (0.01, 2.0), rt.State({"x": 0.5}), rt.State([0, 0]), objective, name="back", **limits)

    def rebound(a: rt.links.Ends, b: rt.links.Ends) -> object:
        return b.start.x["v"] + share * a.end.x["v"]

    bounce = rt.links.Linkage((0, 1), rebound, name="restitution", unit="m/s")
    return rt.Problem([go, back], [rt.links.Jump(0, 1, jumps={"v": None}), bounce])


def _zones(draw: np.random.Generator) -> rt.Problem:
    """Cross two to four zones of 1 m, each with a speed limit of its own, in least time."""
    count = int(draw.integers(2, 5))
    parts = []
    for k in range(count):
        start = rt.State([0, 0]) if k == 0 else rt.State({"x": float(k)})
        end = rt.State([float(count), 0]) if k == count - 1 else rt.State({"x": float(k + 1)})
        speed, force = float(draw.uniform(0.5, 3.0)), {"F": rt.between(-2, 2)}
        limits = {"states": {"v": rt.between(-speed, speed)}, "controls": force}
        parts.append(rt.Phase(_mass(), (0.05, 20.0), start, end, rt.Duration(), name=f"zone {k}", **limits))
    return rt.Problem(parts, [rt.Continuity(k, k + 1) for k in range(count - 1)])


def _carry(draw: np.random.Generator) -> rt.Problem:
    """Go to a load and carry it away."""
    ur5 = arm("ur5")
    loaded = rt.robot.carrying(ur5, rt.robot.CarriedBody("tool0", float(draw.uniform(0.5, 3.0)), (0, 0, 0.06)))
    q = configurations(ur5, draw, 3, step=0.5)
    rests = [rt.State(q=each, v=0) for each in q]
    timed = bool(draw.integers(2))
    times = [2.0 * least_duration(ur5, a, b) + 0.3 for a, b in zip(q[:-1], q[1:], strict=True)]
    objective = rt.Effort() if timed else rt.Duration()
    parts = [
        rt.Phase(robot, times[k] if timed else FREE, rests[k], rests[k + 1], objective, name=name)
        for k, (robot, name) in enumerate(((ur5, "go"), (loaded, "carry")))
    ]
    return rt.Problem(parts, [rt.Continuity(0, 1)])


def planar_legs(draw: np.random.Generator, number: int) -> Drawn:
    """Walk and run with five links."""
    robot = rt.load("five_link", root="planar")
    if number % 4 == 3:
        length, duration = float(draw.uniform(0.6, 1.0)), float(draw.uniform(0.35, 0.45))
        return Drawn(rt.gait.run(robot, step_length=length, duration=duration))
    length, speed = float(draw.uniform(0.3, 0.55)), float(draw.uniform(0.5, 1.0))
    clearance = float(draw.uniform(0.0, 0.06))
    return Drawn(rt.gait.walk(robot, step_length=length, duration=length / speed, clearance=clearance))


def floating_legs(draw: np.random.Generator, number: int) -> Drawn:
    """One step of a trot or a walk at a drawn speed."""
    return Drawn(step(FLOATING[number % 7], float(draw.uniform(0.05, 0.25))))
