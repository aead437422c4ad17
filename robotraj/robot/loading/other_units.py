"""Degrees and millimetres in place of radians and metres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.robot.limits import Limits

OTHER_UNITS = {"rad": ("degrees", np.pi / 180.0, 2.0 * np.pi), "m": ("mm", 1e-3, 1.0)}
"""For a unit the one that may be meant instead, its factor, and the least size at which a message names it."""
LARGER, WITHIN = 5.0, 1.5
"""A limit seems to have another unit if it is so many times the robot's own, and in that unit at most so many times."""


def other_unit_note(own: Limits, given: Limits, units: Sequence[str]) -> str:
    """Name the first position or velocity limit that is plausible in degrees or millimetres only.

    Parameters
    ----------
    own, given : Limits
        Limits of the robot, and those of the caller for the same joints.
    units : sequence of str
        ``"rad"`` or ``"m"`` of each entry of v.

    Returns
    -------
    str
        Empty where every limit is plausible.
    """
    found = []
    for name, suffix in (("position_lower", ""), ("position_upper", ""), ("velocity", "/s")):
        for joint, mine, other, unit in zip(own.joints, getattr(own, name), getattr(given, name), units, strict=True):
            size, least = abs(float(other)), abs(float(mine))
            called, factor, _ = OTHER_UNITS[unit]
            if np.isfinite(size) and 0.0 < LARGER * least < size and factor * size <= WITHIN * least:
                found.append((joint, name.partition("_")[0], mine, other, unit + suffix, called + suffix, factor))
    if not found:
        return ""
    joint, name, mine, other, unit, called, factor = found[0]
    more = f" Further limits of this kind: {len(found) - 1}." if len(found) > 1 else ""
    return (
        f"The {name} limit {other:g} {unit} of {joint!r} is {abs(other / mine):.3g} times the robot's own, {mine:.4g} "
        f"{unit}. The unit is {unit}: {other:g} {called} are {factor * other:.6g} {unit}.{more}"
    )
