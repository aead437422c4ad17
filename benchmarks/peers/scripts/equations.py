"""Accelerations of each task's robot as CasADi graphs: by hand for small ones, Pinocchio's ABA for arms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import pinocchio as pin
from report import urdf
from tasks import Task

from robotraj.symbolic import SymbolicModel

G = 9.81


def cart_pole(q: Any, v: Any, u: Any) -> Any:
    """Move a cart of 1 kg and a pole of 0.3 kg on 0.5 m; solved for the accelerations."""
    cart, pole, length = 1.0, 0.3, 0.5
    s, c = ca.sin(q[1]), ca.cos(q[1])
    below = cart + pole * s**2
    swing = pole * length * v[1] ** 2 * s
    return ca.vertcat(
        (u + swing + pole * G * s * c) / below,
        -(u * c + swing * c + (cart + pole) * G * s) / (length * below),
    )


def acrobot(q: Any, v: Any, u: Any) -> Any:
    """Two uniform rods of 1 m, 1 kg: mass matrix, Coriolis and gravity terms."""
    rod, half = 1 / 3, 0.5  # inertia about an end, distance of the centre of mass
    s, c = ca.sin(q[1]), ca.cos(q[1])
    off = rod + half * c
    mass = ca.vertcat(ca.horzcat(2 * rod + 1 + 2 * half * c, off), ca.horzcat(off, rod))
    coriolis = half * s * ca.vertcat(-v[1] * (2 * v[0] + v[1]), v[0] ** 2)
    lower = half * G * ca.sin(q[0] + q[1])
    gravity = ca.vertcat((1 + half) * G * ca.sin(q[0]) + lower, lower)
    return ca.solve(mass, ca.vertcat(0, u) - coriolis - gravity)


def rates_of(task: Task) -> Callable[[Any, Any, Any], Any]:
    """Accelerations from (q, v, u)."""
    known = {"block": lambda q, v, u: u, "cartpole": cart_pole, "rods": acrobot}
    if task.urdf in known:
        return known[task.urdf]
    model = pin.buildModelFromUrdf(urdf(task))
    aba = SymbolicModel(model).forward_dynamics
    no_forces = ca.DM.zeros(6, model.njoints)
    return lambda q, v, u: aba(q, v, u - ca.DM(model.damping) * v, no_forces)
