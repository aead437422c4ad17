"""Solo12 trots at 0.3 m/s: half a stride on a diagonal pair of feet, closed on its mirror image by an impact."""

from functools import partial

import casadi as ca
import numpy as np

import robotraj as rt

# The URDF says 10 rad, 1000 rad/s and 1000 N m; the motors give 2.7 N m.
robot = rt.load("solo12", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
foot = partial(rt.PointContact, friction=0.5)
# Torques, distance from the standing posture, and a little of the joints' accelerations, which makes swings smooth.
posture = rt.gait.gait_objective(robot, rt.gait.stand(robot, contact=foot))
objective = posture + 1e-5 * rt.Lagrange(lambda point: ca.sumsqr(point.a[6:]))

length, duration = 0.06, 0.2
stride = rt.gait.trot(robot, step_length=length, duration=duration, clearance=0.04, contact=foot, objective=objective)
solution = rt.plan(stride, mesh=rt.Mesh(5, rt.LobattoIIIA(4)))
print(solution)

times = np.linspace(0, duration, 2001)
sample = solution.at(times)
work = np.trapezoid(np.maximum(sample.tau * sample.v[:, 6:], 0).sum(axis=1), times)
weight = 9.81 * sum(inertia.mass for inertia in robot.model.inertias)
print(f"cost of transport {work / (weight * length):.3f}: positive work by weight and distance")

report = rt.validate(solution)
print(report)
report.check(drift=1e-2, contact=1e-4)
opinion = rt.second_opinion(solution, periods=4)
print(opinion)
assert opinion.completed and opinion.upright
print("wrote", rt.replay(solution, "14_solo12_trot.html", periods=6))
