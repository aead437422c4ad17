"""Accelerations that cost a little where dry friction lets joints move in bursts.

Let a light joint with friction F and damping d move at the mean speed v. Steady motion costs (F + d v)^2 a second, and
motion at F / d for the share d v / F of the time 4 F d v, which is less for v < F / d. The joint is free to choose how
many such bursts there are, and when. Torques then jump from mesh to mesh. In the program of the solver a phase with dry
friction has the additional cost

    integral of epsilon PRICE P sum_j (a_j / A)^2 dt,

where P is the cost a second of torques as large as the dry friction [unit of the objective / s], and A^2 the mean of
sum_j a_j^2 along the quintic polynomial of least jerk between the ends,

    A^2 = 120 / 7 |q_e - q_s|^2 / T^4.

The whole way in a tenth of the duration costs a thousand times as much as in all of it. T is the duration, or for a
free one twice the least that speed limits allow. The objective of a solution is that of the problem, without this cost.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.phase import Phase
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot

PRICE = 0.01
"""Cost of the accelerations of the plain motion, relative to ``epsilon`` of that of dry friction.

Without it fewer plans are proved (``benchmarks/friction.md``). With ten times as much the effort of ur3, against
friction of a tenth of its torques, rises by 7 percent instead of 2."""
QUINTIC = 120.0 / 7.0
"""Mean square of the acceleration of the quintic polynomial over 1 rad in 1 s."""


def acceleration_weights(phase: Phase) -> Array:
    """Return the weights of the squares of algebraic variables with epsilon = 1, PRICE P / A^2, (nz,).

    They are 0 without dry friction, on a free root, where the ends are not given, and for objectives that torques do
    not affect at rest.
    """
    if phase not in _KNOWN:
        joints = np.array([variable.name.startswith("a.") for variable in phase.dae.algebraic], dtype=bool)
        weight = _weight(phase) if joints.any() else 0.0
        _KNOWN[phase] = np.where(joints, weight, 0.0)
    return _KNOWN[phase]


_KNOWN: WeakKeyDictionary[Phase, Array] = WeakKeyDictionary()


def _weight(phase: Phase) -> float:
    """Return PRICE P / A^2 of a phase."""
    robot = phase.state_robot
    if robot is None or robot.root != "fixed" or not robot.friction.any() or not phase.integrals:
        return 0.0
    (low, high), (lowest, highest) = ([side[: robot.nq] for side in ends] for ends in phase.joint_ends.values())
    way = np.where((low == high) & (lowest == highest), lowest - low, 0.0)
    if not way.any():
        return 0.0
    accelerations = QUINTIC * float(way @ way) / _duration(phase, robot, way) ** 4
    return PRICE * _cost_of_friction(phase, robot, low) / accelerations


def _duration(phase: Phase, robot: Robot, way: Array) -> float:
    """Return the duration, or a plausible one within its bounds [s]."""
    shortest, longest = phase.duration_bounds
    limits = phase.limits if isinstance(phase.limits, Limits) else robot.limits
    speeds = limits.largest("velocity")
    return float(np.clip(2.0 * np.max(np.abs(way) / speeds), shortest, longest))


def _cost_of_friction(phase: Phase, robot: Robot, q: Array) -> float:
    """Return P: what torques of the size of the dry friction add to the integrands at rest."""
    dae = phase.dae
    rates = [weight * term.rate_of_motion(phase.rows.point) for weight, term in phase.integrals]
    rate = ca.Function("rate", [*phase.rows.symbols], [ca.densify(ca.sum1(ca.vertcat(*rates)))])
    friction = {f"tau.{joint}": force for joint, force in zip(robot.velocity_names, robot.friction, strict=True)}
    x, u = np.zeros(len(dae.states)), np.array([friction.get(control.name, 0.0) for control in dae.controls])
    x[: robot.nq] = np.where(np.isfinite(q), q, 0.0)
    z, p = np.zeros(len(dae.algebraic)), np.ones(len(phase.parameter_names))
    found, without = (float(rate(0.0, x, z, torques, p)) for torques in (u, 0.0 * u))
    return max(0.0, found - without) if np.isfinite(found - without) else 0.0
