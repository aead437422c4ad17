"""Sizes of the joints' accelerations under limits on expressions, as on the speed of a tool or the power of a motor.

Torques of a slow motion hold the robot against gravity, whatever its joints do meanwhile. Many motions of the joints
are then equally short, and equally smooth by their torques. They differ in their accelerations. Let f(w) be a row with
the bound b in the neutral configuration, where joint j alone has the speed w, or else the acceleration w. Torques are
those that hold the robot at its start. With

    d = log2(abs(f(2) - f(0)) / abs(f(1) - f(0))),    w_j = (b / abs(f(1) - f(0)))^(1 / d)

joint j reaches the bound at w_j: d is 1 for a component of a velocity and for a power, and 2 for a squared speed. The
joint that the row slows most has the least w_j = w. The size of the accelerations is

    A = 12 w^2    for a speed: 1 rad at w, with a start and a stop in a twelfth of its time,
    A = w         for an acceleration,

and the least A of all rows counts. A limit that a motion does not come near gives a large one, and weighs nothing.
Limits of single variables, which are bounds of the program, are not among these rows.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind
from robotraj.robot.robot import Robot

STARTS = 12.0
"""Accelerations of a speed in units of its square, over 1 rad or 1 m."""


def acceleration_sizes(phase: Phase) -> Array:
    """Return the sizes of the algebraic variables that are accelerations of joints [rad/s^2, m/s^2], (nz,).

    They are infinite for other variables, and without such limits.
    """
    if phase not in _KNOWN:
        size = _least_size(phase)
        names = [variable.name for variable in phase.dae.algebraic]
        _KNOWN[phase] = np.array([size if name.startswith("a.") else np.inf for name in names], dtype=float)
    return _KNOWN[phase]


_KNOWN: WeakKeyDictionary[Phase, Array] = WeakKeyDictionary()


def _least_size(phase: Phase) -> float:
    robot, names = phase.state_robot, [variable.name for variable in phase.dae.algebraic]
    table = phase.rows
    every = [row for row in (*table.of_state, *table.of_inputs) if row.kind is Kind.PATH]
    rows = [row for row in every if not row.is_equality and row.greatest_bound > 0.0]
    if robot is None or not rows or not all(f"a.{joint}" in names for joint in robot.velocity_names):
        return np.inf
    accelerations = np.array([names.index(f"a.{joint}") for joint in robot.velocity_names])
    n, p = robot.nv, np.ones(len(phase.parameter_names))
    # At rest first, then every joint at speed 1 and 2, then at acceleration 1 and 2.
    x, z = np.zeros((4 * n + 1, len(phase.dae.states))), np.zeros((4 * n + 1, len(names)))
    x[:, : robot.nq] = robot.neutral
    place, size = np.arange(1, 2 * n + 1), np.repeat([1.0, 2.0], n)
    x[place, robot.nq + np.tile(np.arange(n), 2)] = size
    z[place + 2 * n, np.tile(accelerations, 2)] = size
    u = np.tile(_holding(phase, robot), (len(x), 1))
    values = table.sample(rows, np.zeros(len(x)), x, z, u, p)
    once, twice = np.abs(values[1:] - values[0]).reshape(2, 2, n, len(rows)).swapaxes(0, 1)
    bounds = np.array([row.greatest_bound for row in rows])
    with np.errstate(divide="ignore", invalid="ignore"):
        degree = np.log2(twice / once)
        reached = np.where((once > 0.0) & (degree > 0.0), (bounds / once) ** (1.0 / degree), np.inf)
    of_speeds, of_accelerations = reached.min(axis=(1, 2))
    return float(min(STARTS * of_speeds**2, of_accelerations))


def _holding(phase: Phase, robot: Robot) -> Array:
    """Return the torques that hold a robot at the start of a phase, or in its neutral configuration, (nu,)."""
    lower, upper = (bound[: robot.nq] for bound in phase.start_bounds)
    q = lower if np.array_equal(lower, upper) else robot.neutral
    torques = pin.rnea(robot.model, robot.model.createData(), q, np.zeros(robot.nv), np.zeros(robot.nv))
    held = {f"tau.{joint}": float(torque) for joint, torque in zip(robot.velocity_names, torques, strict=True)}
    return np.array([held.get(control.name, 0.0) for control in phase.dae.controls], dtype=float)
