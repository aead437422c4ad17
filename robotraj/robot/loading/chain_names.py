"""Joints of several degrees of freedom by their own name, which stands for the single joints that move in their place.

A caller knows the joint of the file, ``drive``; the robot has ``drive_x``, ``drive_y`` and ``drive_yaw``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from robotraj._util.errors import InputError
from robotraj.robot.limits import Limits

Chains = Mapping[str, tuple[str, ...]]
"""Names of the single joints by the name of the joint that they replace."""

PITCH, STEEPEST = "_pitch", 1.4
"""Ending of the second turn of a ball, and its largest angle [rad].

At a quarter turn the others turn about one axis, and their speeds have no bound. Here they are six times the ball's."""


def chains_note(chains: Chains) -> str:
    """Name the joints that became chains, and their parts."""
    if not chains:
        return ""
    moves = "; ".join(f"{joint!r} moves by {', '.join(parts)}" for joint, parts in chains.items())
    turns = any(part.endswith(PITCH) for parts in chains.values() for part in parts)
    bound = f" The pitch of a ball stays within {STEEPEST:g} rad of 0, where its speeds are defined." if turns else ""
    return f"Joints of several degrees of freedom are chains of single ones: {moves}.{bound}"


def pitches(chains: Chains, limits: Limits) -> dict[str, tuple[float, float]]:
    """Return the position limits of the pitches of balls: the robot's, within ``STEEPEST``."""
    found = {}
    for part in (part for parts in chains.values() for part in parts if part.endswith(PITCH)):
        if part in limits.joints:
            lower, upper = (side[limits.joints.index(part)] for side in limits.sides("position"))
            found[part] = (max(float(lower), -STEEPEST), min(float(upper), STEEPEST))
    return found


def spread_names(joints: Iterable[str], chains: Chains) -> list[str]:
    """Return names of joints with the parts of each chain in place of its own name."""
    return [part for joint in joints for part in chains.get(joint, (joint,))]


def spread_positions(positions: Mapping[str, Any], chains: Chains) -> dict[str, Any]:
    """Return positions by joint with those of a chain's parts: one number each, or 0 for all.

    Raises
    ------
    InputError
        A chain has another number than 0 for several parts, or another count of numbers.
    """
    spread: dict[str, Any] = {}
    for joint, given in positions.items():
        parts = chains.get(joint)
        if parts is None:
            spread[joint] = given
            continue
        values = np.atleast_1d(given).tolist() if np.ndim(given) else [0.0] * len(parts) if given == 0 else []
        if len(values) != len(parts):
            raise InputError(
                f"Joint {joint!r} moves by {', '.join(parts)}; got {given!r} for its position. Give {len(parts)} "
                "numbers in that order [rad, m], or 0."
            )
        spread |= zip(parts, values, strict=True)
    return spread
