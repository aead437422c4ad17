"""T2 by hand: the cart-pole's equations, solved for the accelerations."""

from casadi import cos, sin, vertcat
from hermite_simpson import solve
from report import asked

M, POLE, LENGTH, G = 1.0, 0.3, 0.5, 9.81


def rates(q, v, u):
    s, c = sin(q[1]), cos(q[1])
    below = M + POLE * s**2
    swing = POLE * LENGTH * v[1] ** 2 * s
    return vertcat(
        (u + swing + POLE * G * s * c) / below,
        -(u * c + swing * c + (M + POLE) * G * s) / (LENGTH * below),
    )


solve(asked("T2"), rates)
