"""T3 by hand: the acrobot's mass matrix, Coriolis and gravity terms (two uniform rods of 1 m, 1 kg)."""

import casadi as ca
from hermite_simpson import solve
from report import asked

ROD, HALF, G = 1 / 3, 0.5, 9.81  # inertia about an end, distance of the centre of mass, gravity


def rates(q, v, u):
    s, c = ca.sin(q[1]), ca.cos(q[1])
    off = ROD + HALF * c
    mass = ca.vertcat(ca.horzcat(2 * ROD + 1 + 2 * HALF * c, off), ca.horzcat(off, ROD))
    coriolis = HALF * s * ca.vertcat(-v[1] * (2 * v[0] + v[1]), v[0] ** 2)
    lower = HALF * G * ca.sin(q[0] + q[1])
    gravity = ca.vertcat((1 + HALF) * G * ca.sin(q[0]) + lower, lower)
    return ca.solve(mass, ca.vertcat(0, u) - coriolis - gravity)


solve(asked("T3"), rates)
