"""Bolt on point feet and the legs of Talos on flat feet walk in three dimensions, from the built-in guess.

Bolt's step is closed on its mirror image. Talos's legs differ in inertia, so both of its steps are planned.
"""

from functools import partial

import casadi as ca
import numpy as np

import robotraj as rt

# Bolt's URDF has placeholders of 10 rad, 1000 rad/s and 1000 N m; its motors give 2.7 N m. Talos keeps its own.
bolt = rt.load("bolt", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
talos = rt.load("talos_legs", root="floating")
point = partial(rt.PointContact, friction=0.6)
sole = partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.6)
small = {"feet": ("FL_FOOT", "FR_FOOT"), "contact": point}
large = {"feet": ("left_sole_link", "right_sole_link"), "contact": sole}
fast = {"step_length": 0.06, "duration": 0.2, "clearance": 0.03}
slow = {"step_length": 0.2, "duration": 0.8, "clearance": 0.04, "double_support": 0.2, "repeat": rt.Periodic()}

for robot, on, pace, calm, mesh in (
    (bolt, small, fast, 1e-5, rt.Mesh(6, rt.schemes.LobattoIIIA(4))),
    (talos, large, slow, 0.3, [rt.Mesh(n, rt.schemes.LobattoIIIA(4)) for n in (5, 7, 5, 7)]),
):
    # Torques, distance from the standing posture, and a small weight on joint accelerations for smooth swings.
    cost = rt.gait.gait_objective(robot, rt.gait.stand(robot, **on)) + calm * rt.Lagrange(lambda p: ca.sumsqr(p.a[6:]))
    solution = rt.plan(rt.gait.walk(robot, **on, **pace, objective=cost), mesh=mesh)
    sample = solution.at(np.linspace(0, solution.duration, 2001))
    work = np.trapezoid(np.maximum(sample.tau * sample.v[:, 6:], 0).sum(axis=1), sample.t)
    burden = 9.81 * robot.mass * (sample.q[-1, 0] - sample.q[0, 0])
    print(solution)
    print(f"cost of transport {work / burden:.3f}: positive work by weight and distance")
    print(report := rt.validate(solution))
    report.check(contact=1e-4)
    print(opinion := rt.witness.second_opinion(solution, periods=6))
    assert opinion.completed and opinion.upright
    print("wrote", rt.replay(solution, f"15_{robot.name}_walking.html", periods=6, report=report))
