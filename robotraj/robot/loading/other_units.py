"""Degrees, millimetres and grams in place of radians, metres and kilograms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.robot.limits import Limits

OTHER_UNITS = {"rad": ("degrees", np.pi / 180.0, 2.0 * np.pi), "m": ("mm", 1e-3, 1.0), "kg": ("g", 1e-3, 100.0)}
"""For a unit the one that may be meant instead, its factor, and the least size at which a message names it."""
LARGER, WITHIN = 5.0, 1.5
"""A limit seems to have another unit if it is so many times the robot's own, and in that unit at most so many times."""


def seems_other(given: float, own: float, unit: str) -> bool:
    """Return whether a limit is out of proportion to another one [rad, m, and per s], and plausible in another unit."""
    base = unit.partition("/")[0]
    if base not in OTHER_UNITS or not np.isfinite(given):
        return False
    return 0.0 < LARGER * abs(own) < abs(given) and OTHER_UNITS[base][1] * abs(given) <= WITHIN * abs(own)


def in_other_unit(given: float, unit: str) -> str:
    """Return a sentence on a value that may be in degrees, millimetres or grams."""
    base, *rest = unit.split("/")
    name, factor, _ = OTHER_UNITS[base]
    return f"The unit is {unit}: {given:g} {'/'.join((name, *rest))} are {factor * given:.6g} {unit}."


def doubt_of_unit(value: float, lower: float, upper: float, unit: str) -> str:
    """Return a sentence, after a space, on a value outside its limits that is within them in degrees or millimetres.

    Examples
    --------
    >>> doubt_of_unit(90.0, -3.0, 3.0, "rad")
    ' The unit is rad: 90 degrees are 1.5708 rad.'
    >>> doubt_of_unit(3.5, -3.0, 3.0, "rad")
    ''
    """
    base = unit.partition("/")[0]
    if base not in OTHER_UNITS:
        return ""
    _, factor, least = OTHER_UNITS[base]
    if abs(value) < least or not lower <= factor * value <= upper:
        return ""
    return f" {in_other_unit(value, unit)}"


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
    compared = (
        ("position", own.position_lower, given.position_lower, ""),
        ("position", own.position_upper, given.position_upper, ""),
        ("velocity", own.largest("velocity"), given.largest("velocity"), "/s"),
    )
    found = []
    for name, before, after, suffix in compared:
        for joint, mine, other, unit in zip(own.joints, before.tolist(), after.tolist(), units, strict=True):
            if seems_other(other, mine, unit + suffix):
                found.append((joint, name, mine, other, unit + suffix))
    if not found:
        return ""
    joint, name, mine, other, unit = found[0]
    more = f" Further limits of this kind: {len(found) - 1}." if len(found) > 1 else ""
    return (
        f"The {name} limit {other:g} {unit} of {joint!r} is {abs(other / mine):.3g} times the robot's own, {mine:.4g} "
        f"{unit}. {in_other_unit(other, unit)}{more}"
    )
