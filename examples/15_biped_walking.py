"""Bolt on point feet and the legs of Talos on flat feet walk in three dimensions, from the built-in guess.

Bolt's step is closed on its mirror image. Talos's legs differ in inertia, so both of its steps are planned.
"""

from functools import partial

import numpy as np

import robotraj as rt

# Bolt's URDF has placeholders of 10 rad, 1000 rad/s and 1000 N m; its motors give 2.7 N m. Talos keeps its own.
bolt = rt.load("bolt", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
talos = rt.load("talos_legs", root="floating")
point, sole = partial(rt.PointContact, friction=0.6), partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.6)
quick, calm = rt.Mesh(6, rt.schemes.LobattoIIIA(4)), [rt.Mesh(n, rt.schemes.LobattoIIIA(4)) for n in (5, 7, 5, 7)]


def walk(robot, feet, contact, weight, **pace):
    """Minimise torques, the distance from the standing posture and, for smooth swings, a little the accelerations."""
    posture = rt.gait.stand(robot, feet=feet, contact=contact)
    cost = rt.gait.gait_objective(robot, posture) + weight * rt.Lagrange(lambda p: p.a[6:].T @ p.a[6:])
    return rt.gait.walk(robot, feet=feet, contact=contact, objective=cost, **pace)


small = walk(bolt, ("FL_FOOT", "FR_FOOT"), point, 1e-5, step_length=0.06, duration=0.2, clearance=0.03)
stride = {"step_length": 0.2, "duration": 0.8, "clearance": 0.04, "double_support": 0.2, "repeat": rt.Periodic()}
large = walk(talos, ("left_sole_link", "right_sole_link"), sole, 0.3, **stride)
for robot, gait, mesh in ((bolt, small, quick), (talos, large, calm)):
    solution = rt.plan(gait, mesh=mesh)
    sample = solution.at(np.linspace(0, solution.duration, 2001))
    work = np.trapezoid(np.maximum(sample.tau * sample.v[:, 6:], 0).sum(axis=1), sample.t)
    burden = 9.81 * robot.mass * np.ptp(sample.q[:, 0])
    print(solution, f"cost of transport {work / burden:.3f}: positive work by weight and distance", sep="\n")
    print(report := rt.validate(solution))
    report.check(contact=1e-4)
    print(opinion := rt.witness.second_opinion(solution, periods=6))
    assert opinion.completed and opinion.upright
    print("wrote", rt.replay(solution, f"15_{robot.name}_walking.html", periods=6, report=report))
