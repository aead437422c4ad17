"""Problems of all kinds, small, for the tests of stages and of solvers that take them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np

import robotraj as rt
from tests.gait import test_five_link as five_link

START = [-1.1, -1.8, 1.6, -1.2, -1.57, 0.0]
GOAL = [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]


def arm() -> rt.Problem:
    """ur5 from rest to rest in a second."""
    robot = rt.load("ur5")
    return rt.Problem(
        [
            rt.Phase(
                robot,
                duration=1.0,
                start=rt.State(q=START, v=0),
                end=rt.State(q=GOAL, v=0),
                objective=rt.Effort(),
            )
        ]
    )


def hurried_arm() -> rt.Problem:
    """Minimum time of the ur5."""
    (phase,) = arm().phases
    return rt.Problem([replace(phase, duration=(0.4, 5.0), objective=rt.Duration())])


def smooth_arm() -> rt.Problem:
    """The ur5 with rates of torques: torques are states, their rates the controls."""
    (phase,) = arm().phases
    objective = rt.Duration() + 1e-6 * rt.objectives.TorqueRate()
    return rt.Problem([replace(phase, duration=(0.4, 5.0), objective=objective)])


def jerky_arm() -> rt.Problem:
    """Jerks of the ur5 beside its accelerations, the duration free."""
    (phase,) = arm().phases
    return rt.Problem([replace(phase, duration=(0.4, 5.0), objective=rt.Duration() + 1e-6 * rt.objectives.Jerk())])


def acrobot() -> rt.Problem:
    """One motor for two joints: a torque balance stays an equality. Solvers find the same optimum on any mesh."""
    robot = rt.load("acrobot")
    return rt.Problem(
        [
            rt.Phase(
                robot,
                duration=(1.0, 2.0),
                start=rt.State(q=[0, 0], v=0),
                end=rt.State(q=[-0.3, 0.5], v=0),
                objective=rt.Effort() + 0.1 * rt.Duration(),
            )
        ]
    )


def block() -> rt.Problem:
    """Minimum time of a block."""
    system = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
    return rt.Problem(
        [
            rt.Phase(
                system,
                duration=(0.1, 20),
                start=rt.State({"x": 0, "v": 0}),
                end=rt.State({"x": 10, "v": 0}),
                controls={"u": rt.between(-1, 1)},
                objective=rt.Duration(),
            )
        ]
    )


def linear() -> rt.Problem:
    """Rates that read all states: the defects of an interval define its states only together."""
    system = rt.System(
        states=["x", "y"], controls=["u"], dynamics=lambda p: [p.x["y"], -p.x["x"] - p.x["y"] + p.u["u"]]
    )
    return rt.Problem(
        [
            rt.Phase(
                system,
                duration=2.0,
                start=rt.State({"x": 0, "y": 0}),
                end=rt.State({"x": 1, "y": 0}),
                objective=rt.Lagrange(lambda p: p.u["u"] ** 2),
            )
        ]
    )


def robot_block() -> rt.Problem:
    """A robot whose torque balance is linear but for the duration."""
    ends = [rt.State(q=[x], v=0) for x in (10, 0)]
    return rt.Problem([rt.Phase(rt.load("block"), (0.1, 200), *ends, objective=rt.Duration())])


def pendulum() -> rt.Problem:
    """Swing-up of a nonlinear system with a Lagrange term."""
    system = rt.System(
        states=["angle", "rate"],
        controls=["torque"],
        dynamics=lambda p: [p.x["rate"], p.u["torque"] - 9.81 * ca.sin(p.x["angle"])],
    )
    return rt.Problem(
        [
            rt.Phase(
                system,
                duration=2.0,
                start=rt.State({"angle": 0, "rate": 0}),
                end=rt.State({"angle": np.pi, "rate": 0}),
                controls={"torque": rt.between(-15, 15)},
                objective=rt.Lagrange(lambda p: p.u["torque"] ** 2),
            )
        ]
    )


def two_phases() -> rt.Problem:
    """A block that goes out and comes back, the turning point free."""
    system = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
    controls = {"u": rt.between(-1, 1)}
    energy = rt.Lagrange(lambda p: p.u["u"] ** 2)
    out = rt.Phase(
        system,
        duration=(0.5, 5),
        start=rt.State({"x": 0, "v": 0}),
        end=rt.State({"x": 1}),
        controls=controls,
        objective=energy + rt.Duration(),
        name="out",
    )
    back = rt.Phase(
        system,
        duration=(0.5, 5),
        end=rt.State({"x": 0, "v": 0}),
        controls=controls,
        objective=energy + rt.Duration(),
        name="back",
    )
    return rt.Problem([out, back], links=[rt.Continuity(0, 1)])


def arm_by_way() -> rt.Problem:
    """The ur5 on its way past a posture, both durations free: the link reads the speeds of two clocks."""
    robot, objective = rt.load("ur5"), rt.Duration() + 1e-4 * rt.Effort()
    out = rt.Phase(robot, (0.3, 3.0), rt.State(q=START, v=0), rt.State(q=[0, -1, 1, -1, -1, 0.5]), objective)
    back = rt.Phase(robot, (0.3, 3.0), None, rt.State(q=GOAL, v=0), objective)
    return rt.Problem([out, back], links=[rt.Continuity(0, 1)])


def step() -> rt.Problem:
    """One periodic step of the five-link biped: a contact, an impact, a mirror that couples both ends."""
    return five_link.step(rt.load("five_link", root="planar"))


EVERY: dict[str, Callable[[], rt.Problem]] = {
    "arm": arm,
    "hurried arm": hurried_arm,
    "smooth arm": smooth_arm,
    "jerky arm": jerky_arm,
    "block": block,
    "linear": linear,
    "pendulum": pendulum,
    "robot block": robot_block,
    "acrobot": acrobot,
    "two phases": two_phases,
    "arm by way": arm_by_way,
    "step": step,
}
