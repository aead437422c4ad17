"""Generalised forces of motors and springs, and of the damping and dry friction that a URDF gives its joints.

    B tau - K (q - rest) - d v - F tanh(v / v_s)

with K the stiffness of springs, d the damping, F the dry friction and v_s the robot's ``friction_speed``. The last term
is a smooth F sign(v). A softening c > 0 replaces tanh(s), s = v / v_s, by

    s / sqrt(s^2 + c^2) = tanh(asinh(s / c))    from c = 1,
    tanh(asinh(c s) / c)                        below, which is tanh(s) at c = 0,

so that what is left beside a reversal falls as s^-2, then as s^(-2 / c), and at last exponentially. That is another
friction, whose solutions are guesses only (``robotraj.planning.proving.soft_friction``). It may be averaged over the
times from t - e to t + e, when the speed is taken to be v + a (t' - t):

    2 s / (sqrt((s + d)^2 + c^2) + sqrt((s - d)^2 + c^2)),  d = a e / v_s,

and below c = 1 with c s times sqrt((c s)^2 + 1) over the mean of that root at s + d and s - d.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj.dynamics.variable import Column
from robotraj.robot.robot import Robot


def joint_forces(
    robot: Robot,
    q: ca.SX,
    v: ca.SX,
    tau: ca.SX,
    damping: Column,
    softening: float = 0.0,
    change: ca.SX | None = None,
) -> ca.SX:
    """Return the generalised force of the motors, the springs, the damping and the friction, (nv,) [N m, N].

    Parameters
    ----------
    robot : Robot
        Its motors, its springs, its dry friction and the speed of its friction.
    q : casadi.SX (nq,)
        Positions [rad, m].
    v : casadi.SX (nv,)
        Velocities [rad/s, m/s].
    tau : casadi.SX (nu,)
        Torques and forces of the motors [N m, N].
    damping : array or casadi.SX (nv,)
        Viscous damping, of the design if there is one [N m s/rad, N s/m].
    softening : float
        c; 0 for the robot's own friction.
    change : casadi.SX (nv,), optional
        a e, by which speeds change within the time over which soft friction is averaged [rad/s, m/s].
    """
    force = ca.SX(robot.nv, 1)
    for i, joint in enumerate(robot.actuated):
        force[robot.velocity_names.index(joint)] = tau[i]
    for joint, stiffness, rest in robot.springs:
        force[robot.velocity_names.index(joint)] -= stiffness * (q[robot.position_names.index(joint)] - rest)
    # A robot without damping has no product in its graph.
    if not isinstance(damping, np.ndarray) or damping.any():
        force -= damping * v
    return force - dry_friction(robot, v, softening, change)


def dry_friction(robot: Robot, v: ca.SX, softening: float = 0.0, change: ca.SX | None = None) -> ca.SX:
    """Return the dry friction F tanh(v / v_s), (nv,) [N m, N]; parameters as in ``joint_forces``."""
    force = ca.SX(robot.nv, 1)
    # Frictionless joints have no tanh in the graph.
    for i in np.flatnonzero(robot.friction).tolist():
        relative = None if change is None else change[i] / robot.friction_speed
        force[i] = robot.friction[i] * _saturation(v[i] / robot.friction_speed, softening, relative)
    return force


def _saturation(speed: ca.SX, softening: float, change: ca.SX | None) -> ca.SX:
    """Return the share of the dry friction, from -1 to 1; speeds are relative to ``friction_speed``."""
    if not softening:
        return ca.tanh(speed)
    if softening < 1.0:
        slow = softening * speed
        if change is not None:
            slow *= ca.sqrt(slow**2 + 1.0) / _mean_size(slow, softening * change, 1.0)
        return ca.tanh(ca.asinh(slow) / softening)
    if change is None:
        return speed / ca.sqrt(speed**2 + softening**2)
    return speed / _mean_size(speed, change, softening)


def _mean_size(speed: ca.SX, change: ca.SX, width: float) -> ca.SX:
    """Return the mean of sqrt(s^2 + c^2) at s + d and s - d."""
    return 0.5 * (ca.sqrt((speed + change) ** 2 + width**2) + ca.sqrt((speed - change) ** 2 + width**2))
