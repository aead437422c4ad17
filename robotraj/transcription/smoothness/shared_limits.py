"""Sizes of the joints' accelerations under limits of a speed or an acceleration that joints share, as of a tool.

Torques of a slow motion hold the robot against gravity, whatever its joints do meanwhile. Many motions of the joints
are then equally short, and equally smooth by their torques. Their accelerations tell them apart. Let f(w) be a row with
the bound b in the neutral configuration, where joint j alone has the speed w, or else the acceleration w, and

    d = log2(abs(f(2) - f(0)) / abs(f(1) - f(0))),    w_j = (b / abs(f(1) - f(0)))^(1 / d),

so that joint j reaches the bound at w_j: d is 1 for a component of a velocity, and 2 for its square. The joint that
moves the frame most has the least w_j = w. The size of the accelerations is

    A = 12 w^2    for a speed: 1 rad at w, with a start and a stop in a twelfth of its time,
    A = w         for an acceleration,

and the least A of all rows counts. A limit that a motion does not come near gives a large one, and weighs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robotraj.problem.phase_row import Kind

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]
Columns = NDArray[np.int_]

STARTS = 12.0
"""Accelerations of a speed in units of its square, over 1 rad or 1 m."""
SHARING = 2
"""Least number of joints that share a limit."""


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
    if robot is None or not all(f"a.{joint}" in names for joint in robot.velocity_names):
        return np.inf
    speeds = robot.nq + np.arange(robot.nv)
    accelerations = np.array([names.index(f"a.{joint}") for joint in robot.velocity_names])
    of_speeds = _reached(phase, of_state=True, columns=speeds)
    of_accelerations = _reached(phase, of_state=False, columns=accelerations)
    return float(min([np.inf, *(STARTS * of_speeds**2), *of_accelerations]))


def _reached(phase: Phase, of_state: bool, columns: Columns) -> Array:
    """Return the least w_j of rows of speeds, columns of the state, or of accelerations, columns of z."""
    table, count = phase.rows, len(columns)
    every = table.of_state if of_state else table.of_inputs
    rows = [row for row in every if row.kind is Kind.PATH and not row.is_equality and row.greatest_bound > 0.0]
    if not rows:
        return np.zeros(0)
    assert phase.state_robot is not None
    x = np.zeros((2 * count + 1, len(phase.dae.states)))
    x[:, : phase.state_robot.nq] = phase.state_robot.neutral
    z = np.zeros((len(x), len(phase.dae.algebraic)))
    (x if of_state else z)[np.arange(1, len(x)), np.tile(columns, 2)] = np.repeat([1.0, 2.0], count)
    u, p = np.zeros((len(x), len(phase.dae.controls))), np.ones(len(phase.parameter_names))
    values = table.sample(rows, np.zeros(len(x)), x, z, u, p)
    once, twice = np.abs(values[1:] - values[0]).reshape(2, count, len(rows))
    bounds = np.array([row.greatest_bound for row in rows])
    with np.errstate(divide="ignore", invalid="ignore"):
        degree = np.log2(twice / once)
        reached = np.where((once > 0.0) & (degree > 0.0), (bounds / once) ** (1.0 / degree), np.inf)
    shared = np.isfinite(reached).sum(axis=0) >= SHARING
    return np.asarray(reached.min(axis=0)[shared])
