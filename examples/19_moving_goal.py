"""A ur5 follows a goal that moves, planned again every 20 ms from its state; the whole arm avoids a ball and a box."""

import casadi as ca
import numpy as np

import robotraj as rt

ur5 = rt.load("ur5")
names = [f"goal.{i}" for i in range(6)]


def goal(t):
    """Goal of the joints at time t [rad]."""
    still = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
    return still + 0.3 * np.sin(2.0 * t) * np.array([1.0, -0.5, 0.5, 0.0, 0.0, 1.0])


ball = rt.obstacles.Sphere(0.1, lambda t: (0.7 + 0.03 * ca.sin(3.0 * t), 0.2, 0.42))
box = rt.obstacles.Box((0.3, 0.3, 0.4), (-0.5, 0.5, 0.2))

home = [-1.1, -1.8, 1.6, -1.2, -1.57, 0.0]
follow = rt.Phase(
    ur5,
    duration=1.0,  # the horizon
    start=rt.State(q=home, v=0),
    end=rt.State(v=0),
    objective=rt.Lagrange(lambda p: sum((p.q[i] - p.p[names[i]]) ** 2 for i in range(6))) + 1e-5 * rt.Effort(),
    constraints=[rt.CollisionFree([ball, box], margin=0.01)],
    parameters=dict(zip(names, goal(0.0), strict=True)),
)
replanner, replans = rt.Replanner(follow, mesh=rt.Mesh(20)), []
q, v = np.array(home), np.zeros(6)
for t in np.arange(150) * 0.02:
    replans.append(replanner.step(t, rt.State(q=q, v=v), parameters=dict(zip(names, goal(t), strict=True))))
    reached = replans[-1].at(t + 0.02)  # the robot follows its plan; a real one is measured here
    q, v = reached.q, reached.v
print(f"distance from the goal: {np.abs(q - goal(3.0)).max():.3f} rad")
print("wrote", rt.replay(rt.applications.driven(replans, until=3.0), "19_moving_goal.html", traces=["tool0"]))
