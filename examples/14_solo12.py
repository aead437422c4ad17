"""Solo12 trots at 0.3 m/s on alternating diagonal pairs of feet, and jumps 10 cm forward and 8 cm up."""

from functools import partial

import casadi as ca
import numpy as np

import robotraj as rt

# The URDF's limits are placeholders of 10 rad, 1000 rad/s and 1000 N m; the motors give 2.7 N m.
robot = rt.load("solo12", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
foot = partial(rt.PointContact, friction=0.5)
# Torques, distance from the standing posture, and a small weight on joint accelerations for smooth swings.
posture = rt.gait.gait_objective(robot, rt.gait.stand(robot, contact=foot))
calm = 1e-5 * rt.Lagrange(lambda point: ca.sumsqr(point.a[6:]))

# Half a stride; the impact of the other two feet links it to its mirror image.
trot = rt.gait.trot(robot, step_length=0.06, duration=0.2, clearance=0.04, contact=foot, objective=posture + calm)
# A small load is kept on standing feet, because the friction cone is not smooth at its tip.
loaded = partial(foot, cone=rt.contacts.Linearised(4), normal_force=(0.5, 40.0))
jump = rt.gait.jump(robot, length=0.1, height=0.08, push=0.25, land=0.25, contact=loaded, objective=posture + 10 * calm)
meshes = rt.Mesh(5, rt.schemes.LobattoIIIA(4)), [rt.Mesh(n, rt.HermiteSimpson()) for n in (18, 12, 14)]

weight = 9.81 * sum(inertia.mass for inertia in robot.model.inertias)
for name, problem, mesh, periods in (("trot", trot, meshes[0], 4), ("jump", jump, meshes[1], 1)):
    solution = rt.plan(problem, mesh=mesh)
    print(solution)
    times = np.linspace(0, solution.duration, 2001)
    sample = solution.at(times)
    work = np.trapezoid(np.maximum(sample.tau * sample.v[:, 6:], 0).sum(axis=1), times)
    way = sample.q[-1, 0] - sample.q[0, 0]
    print(f"cost of transport {work / (weight * way):.3f}: positive work by weight and distance")
    print(report := rt.validate(solution))
    report.check(drift=1e-2, contact=1e-4)
    print(opinion := rt.witness.second_opinion(solution, periods=periods))
    assert opinion.completed and opinion.upright
    print("wrote", rt.replay(solution, f"14_solo12_{name}.html", periods=periods, report=report))
