"""What gives way: sizes before signs, quantities instead of their squares, demands before a robot's own limits."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt


def rocket(duration: float, most: float) -> rt.Phase:
    """Rise by 100 m from rest to rest; gravity takes 9.81 of the thrust per mass."""
    system = rt.System(["h", "v"], ["thrust"], lambda p: [p.x["v"], p.u["thrust"] - 9.81])
    ends = rt.State({"h": 0, "v": 0}), rt.State({"h": 100, "v": 0})
    effort = rt.Lagrange(lambda p: (p.u["thrust"] / 20.0) ** 2)
    return rt.Phase(system, duration, *ends, effort, controls={"thrust": rt.between(0, most)})


def test_a_weak_rocket_needs_a_larger_thrust_and_no_negative_one() -> None:
    (thrust, *_) = rt.plan(rocket(6.0, 15.0), check=False, progress=False).conflicts
    assert thrust.name == "control bound, thrust" and thrust.bound == 15.0
    assert rt.plan(rocket(6.0, thrust.needed), progress=False).success


@pytest.mark.slow
@pytest.mark.parametrize("name", ["linear speed", "torque budget"])
def test_what_the_user_demands_is_named_alone(name: str) -> None:
    robot = rt.load("ur10")
    start, end = np.array([-1.2, -1.4, 1.3, -0.8, -0.9, 0.2]), np.array([1.0, -0.9, 0.5, 0.4, 0.8, -0.5])
    limit: rt.constraints.Constraint = rt.constraints.FrameSpeed("tool0", linear=0.1)
    if name == "torque budget":
        limit = rt.constraints.IntegralConstraint(lambda p: ca.sumsqr(p.tau), upper=10.0, name=name)
    # The last joint is free, so that the way of the tool is not known before the solve.
    ends = rt.State(q=start, v=0), rt.State(q=dict(zip(robot.position_names[:-1], end[:-1], strict=True)), v=0)
    phase = rt.Phase(robot, 1.8, *ends, rt.Effort(), constraints=[limit])
    conflicts = rt.plan(phase, check=False, progress=False).conflicts
    assert conflicts[0].name.startswith(name)
    assert {conflict.name for conflict in conflicts[1:]} <= {"duration"}
