"""Margins of gaits: a share of cone, sole, torque and speed that plans keep back for a controller."""

from __future__ import annotations

from dataclasses import fields, is_dataclass

import numpy as np

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import Contact, copied
from robotraj.gait.checks import number
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between, between
from robotraj.problem.constraints.joint_limits import JointEffort, JointVelocity
from robotraj.robot.robot import Robot

MARGIN = 0.1
"""Default share that gaits keep back."""


def checked_margin(value: object) -> float:
    """Return a margin, from 0 to less than 1.

    Raises
    ------
    InputError
        The value is no such number.
    """
    margin = number(value, "margin", "")
    if not 0.0 <= margin < 1.0:
        raise InputError(f"margin= is {value!r}; give the share to keep back, from 0 to less than 1.")
    return margin


def contact_with(contact: Contact, margin: float) -> Contact:
    """Return a contact that keeps back at least that share of its friction and sole."""
    known = any(entry.name == "margin" for entry in fields(contact)) if is_dataclass(contact) else False
    return copied(contact, margin=margin) if known and contact.margin < margin else contact


def limits_with(robot: Robot, margin: float) -> list[Constraint]:
    """Return tighter bounds on torques and speeds; the limits of the phase remain those that a controller has."""
    if not margin:
        return []
    torques, speeds = (_tighter(robot, quantity, margin) for quantity in ("effort", "velocity"))
    torques = {joint: bounds for joint, bounds in torques.items() if joint in robot.actuated}
    rows: list[Constraint] = [JointEffort(torques)] if torques else []
    return [*rows, JointVelocity(speeds)] if speeds else rows


def _tighter(robot: Robot, quantity: str, margin: float) -> dict[str, Between]:
    """Return the bounds of the joints that have limits of a quantity."""
    sides = zip(*robot.limits.sides(quantity), strict=True)
    return {
        joint: between((1.0 - margin) * float(lower), (1.0 - margin) * float(upper))
        for joint, (lower, upper) in zip(robot.velocity_names, sides, strict=True)
        if np.isfinite(lower) or np.isfinite(upper)
    }
