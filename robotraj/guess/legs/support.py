"""Contact forces and torques that balance a motion, by least squares."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.mobility import AXES
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Variable
from robotraj.guess.legs.stance import SHORT, BalancedStance

SHARE = 0.1
"""Least normal force of a standing foot, relative to an equally shared weight."""
INSIDE = 0.7
"""Largest tangential force, relative to the friction cone."""


def support(stance: BalancedStance, held: Sequence[str], q: Array, v: Array, a: Array) -> tuple[Array, Array]:
    """Compute contact forces and motor torques of a motion q, v, a.

    The forces solve the equations of the unactuated joints, B_0' (RNEA(q, v, a) + d(v) - J' f) = 0, in the
    least-squares sense with least norm. They are then projected into their cones. tau follows from the equations of
    the actuated joints. At rest these are the forces of static equilibrium.

    Returns
    -------
    forces : (m,) array
        Forces of the contacts ``held`` in the order of ``stance.contacts`` [N, N m].
    tau : (nu,) array
        Torques of the motors [N m, N].
    """
    robot = stance.robot
    model = robot.model
    needed = pin.rnea(model, stance.data, q, v, a) + robot.resistance(q, v)
    columns = stance.columns(held)
    jacobian = stance.jacobian(q)[columns].T
    forces = np.zeros(len(columns))
    if columns:
        idle = ~robot.actuation.any(axis=1)
        weights = np.array([1.0 if f.unit == "N" else SHORT * stance.size for f in _forces(stance, held)])
        # Moments on the root are divided by the size of the robot.
        rows = stance.scales(["rad" if unit == "m" else "m" for unit in np.array(robot.units)[idle]])[:, None]
        balance = jacobian[idle] * weights / rows
        # With redundant contacts, the least norm shares the load evenly.
        forces = weights * (np.linalg.pinv(balance, rcond=1e-6) @ (needed[idle] / rows[:, 0]))
        weight = pin.computeTotalMass(model) * float(np.linalg.norm(model.gravity.linear))
        forces = inside(stance, held, forces, SHARE * weight / max(len(held), 1))
    torque = needed - jacobian @ forces
    return forces, np.asarray(robot.actuation.T @ torque)


def _forces(stance: BalancedStance, held: Sequence[str]) -> list[Variable]:
    return [force for contact in stance.contacts if contact.name in held for force in contact.forces]


def inside(stance: BalancedStance, held: Sequence[str], forces: Array, least: float) -> Array:
    """Return forces inside their cones: normal forces of at least ``least``, tangential forces and moments reduced."""
    forces, first = np.array(forces), 0
    for contact in stance.contacts:
        if contact.name not in held:
            continue
        axes = [force.name.rsplit(".", 1)[-1] for force in contact.forces]
        if contact.contact.ground is not None:
            own = forces[first : first + len(axes)]
            _shrink(contact, as_ground(contact.contact.ground), axes, own, least, SHORT * stance.size)
        first += len(axes)
    return forces


def _shrink(contact: BoundContact, ground: Ground, axes: Sequence[str], own: Array, least: float, lever: float) -> None:
    normal = AXES[ground.axis]
    if normal not in axes:
        return
    up = max(ground.side * own[axes.index(normal)], least)
    own[axes.index(normal)] = ground.side * up
    along = [i for i, axis in enumerate(axes) if axis in "xyz" and axis != normal]
    size = np.linalg.norm(own[along])
    allowed = INSIDE * contact.contact.planned_friction * up
    if size > allowed:
        own[along] *= allowed / size
    about = [i for i, axis in enumerate(axes) if axis.startswith("m")]
    most = 0.2 * lever * up
    own[about] = np.clip(own[about], -most, most)
