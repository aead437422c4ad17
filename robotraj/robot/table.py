"""A robot as a table for people: one line per joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from robotraj.robot.robot import Robot

HEAD = (
    "joint",
    "unit",
    "position",
    "velocity",
    "acceleration",
    "effort",
    "motor",
    "damping",
    "friction",
    "neutral",
)
RATES = {"rad": ("rad/s", "rad/s^2", "N m"), "m": ("m/s", "m/s^2", "N")}


def _number(value: float, unit: str = "") -> str:
    return "-" if np.isinf(value) else f"{value:.4g} {unit}".strip()


def _interval(low: float, high: float) -> str:
    return "-" if np.isinf(low) and np.isinf(high) else f"[{low:.4g}, {high:.4g}]"


def table(robot: Robot) -> str:
    """Write the robot's joints with units, limits (``-``: none), motors and damping; then its notes."""
    limits = robot.limits
    rows = [HEAD]
    quaternion = robot.nq - robot.nv  # a floating root's positions are no joints'
    for i, (joint, unit) in enumerate(zip(robot.velocity_names, robot.units, strict=True)):
        speed, rate, effort = RATES[unit]
        rows.append(
            (
                joint,
                unit,
                _interval(limits.position_lower[i], limits.position_upper[i]),
                _number(limits.velocity[i], speed),
                _number(limits.acceleration[i], rate),
                _number(limits.effort[i], effort),
                "yes" if joint in robot.actuated else "no",
                _number(robot.damping[i]),
                _number(robot.friction[i]),
                "-" if quaternion and i < limits.free else _number(robot.neutral[i + quaternion]),
            )
        )
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    lines.insert(1, "-" * max(len(line) for line in lines))
    moving = robot.nv - limits.free
    root = "" if robot.root == "fixed" else f"{robot.root} root, "
    title = (
        f"{robot.name}: {root}{moving} moving joint{'s' if moving != 1 else ''}, {robot.nu} actuated, "
        f"{sum(inertia.mass for inertia in list(robot.model.inertias)[1:]):.4g} kg moving, from "
        f"{robot.origin}"
    )
    if quaternion:
        place = zip(robot.position_names, robot.neutral, robot.position_units, strict=True)
        stands = ", ".join(f"{name} {_number(value, unit)}" for name, value, unit in list(place)[: limits.free + 1])
        lines.append(f"neutral root: {stands}; velocities in the root link's own axes")
    notes = [f"note: {note}" for note in (*robot.notes, *robot.limits.complaints(robot.actuated))]
    return "\n".join([title, *lines, *notes])
