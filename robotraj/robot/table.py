"""A robot's joints as a table: one line per joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj.robot.limits import Limits

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


class Joints(NamedTuple):
    """What the table lists of every joint, in the order of the velocities.

    Attributes
    ----------
    names, units : sequence of str
    limits : Limits
    motors : sequence of bool
    damping, friction : (nv,) [N m s/rad, N s/m], [N m, N]
    neutral : (nv,) [rad, m]
        NaN where the joint's position is a part of a quaternion.
    """

    names: Sequence[str]
    units: Sequence[str]
    limits: Limits
    motors: Sequence[bool]
    damping: NDArray[np.float64]
    friction: NDArray[np.float64]
    neutral: NDArray[np.float64]


def number(value: float, unit: str = "") -> str:
    """Write a number with its unit; ``-`` where there is none."""
    return f"{value:.4g} {unit}".strip() if np.isfinite(value) else "-"


def _interval(low: float, high: float) -> str:
    return "-" if np.isinf(low) and np.isinf(high) else f"[{low:.4g}, {high:.4g}]"


def joint_table(joints: Joints) -> list[str]:
    """Write the joints with units, limits (``-``: none), motors and damping, a line each."""
    limits = joints.limits
    rows = [HEAD]
    for i, (joint, unit) in enumerate(zip(joints.names, joints.units, strict=True)):
        speed, rate, effort = RATES[unit]
        rows.append(
            (
                joint,
                unit,
                _interval(limits.position_lower[i], limits.position_upper[i]),
                number(limits.velocity[i], speed),
                number(limits.acceleration[i], rate),
                number(limits.effort[i], effort),
                "yes" if joints.motors[i] else "no",
                number(joints.damping[i]),
                number(joints.friction[i]),
                number(joints.neutral[i]),
            )
        )
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    lines.insert(1, "-" * max(len(line) for line in lines))
    return lines
