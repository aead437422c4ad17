"""Limits of joints that differ between left and right, as where a URDF gives those of the next joint."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from robotraj.robot.joint_table import interval
from robotraj.robot.limits import Limits
from robotraj.robot.sides.other_side import other_side

ALIKE = 1e-2
"""Difference of limits up to which they are alike: of positions in rad or m, of others relative to the larger one."""


def sides_note(own: Limits, wanted: Limits, units: Sequence[str]) -> str:
    """Name the first joint whose limits are neither those of the joint on the other side nor their mirror image.

    Pairs that differ only in ``wanted``, by choice of the user, are not named.
    """
    differing = _unlike_sides(own, units)
    left = {pair: text for pair, text in _unlike_sides(wanted, units).items() if pair in differing}
    if not left:
        return ""
    more = f" {len(left) - 1} more pairs of joints differ too." if len(left) > 1 else ""
    return (
        f"Left and right have different limits: {next(iter(left.values()))}.{more} If that is a mistake, correct it "
        "with limits=."
    )


def _unlike_sides(limits: Limits, units: Sequence[str]) -> dict[tuple[str, str], str]:
    """Return the pairs of joints with different limits, and the first difference of each in words."""
    found: dict[tuple[str, str], str] = {}
    joints = list(limits.joints)
    for i, joint in enumerate(joints):
        k = joints.index(other_side(joint, joints))
        if k <= i:
            continue
        pair, unit = (joint, joints[k]), units[i]
        motor = "N" if unit == "m" else "N m"
        for name, quantity, of, relative in (
            ("positions", "position", unit, 0.0),
            ("speed", "velocity", f"{unit}/s", ALIKE),
            ("effort", "effort", motor, ALIKE),
        ):
            lower, upper = limits.sides(quantity)
            here, there = ((lower[j], upper[j]) for j in (i, k))
            alike = (np.allclose(here, seen, relative, ALIKE - relative) for seen in (there, (-there[1], -there[0])))
            if not any(alike):
                found[pair] = _difference(name, pair, (interval(*ends, f" {of}") for ends in (here, there)))
                break
    return found


def _difference(name: str, pair: tuple[str, str], values: Iterable[str]) -> str:
    """Write the values of one limit of both joints."""
    first, second = values
    return f"{name} of {pair[0]!r} {first}, of {pair[1]!r} {second}"
