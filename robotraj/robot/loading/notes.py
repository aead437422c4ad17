"""Notes on the decisions of loading, one sentence each; empty if there was no decision."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.robot.limits import Limits
from robotraj.robot.loading.mimic import Mimic

Array = NDArray[np.float64]


def mimic_note(mimics: Sequence[Mimic], held: Mapping[str, float], asked: Mapping[str, float]) -> str:
    """Name the coupled joints that were locked by default."""
    coupled = {joint for mimic in mimics for joint in (mimic.leader, mimic.follower)} - set(asked)
    if not coupled:
        return ""
    places = ", ".join(f"{joint} at {held[joint]:.4g}" for joint in held if joint in coupled)
    return (
        f"Joints coupled by <mimic> are locked: {places}. Choose where with locked={{leader: value}}, "
        "or load a pin.Model built with mimic=False to move them independently."
    )


def weightless_note(joints: Sequence[str]) -> str:
    """Name the joints that move neither mass nor inertia."""
    if not joints:
        return ""
    return (
        f"No mass moves with {', '.join(map(repr, joints))}, so the mass matrix is singular. Give the links an "
        "<inertial>, or lock the joints with locked={joint: value}."
    )


def renamed_frames_note(names: Sequence[str]) -> str:
    """Name the joint frames that were renamed because a link has the same name."""
    if not names:
        return ""
    return f"Links and joints share names; the joints' frames got the ending _joint: {', '.join(names)}."


def dissipation_note(model: pin.Model) -> str:
    """State the source of damping and friction."""
    if not np.any(model.damping) and not np.any(model.upperDryFrictionLimit):
        return ""
    return (
        "Damping and friction are the model's (a URDF's <dynamics>); Pinocchio's dynamics ignore "
        "them, robotraj adds them."
    )


def friction_note(friction: Array, limits: Limits, units: Sequence[str], actuated: Collection[str]) -> str:
    """Name the joints whose friction is as large as their effort limit."""
    stuck = [
        f"{joint} ({friction[i]:.4g} of {limits.effort[i]:.4g} {'N' if units[i] == 'm' else 'N m'})"
        for i, joint in enumerate(limits.joints)
        if joint in actuated and friction[i] > 0 and friction[i] >= limits.effort[i]
    ]
    if not stuck:
        return ""
    return (
        f"Friction is at least as large as the effort limit: {', '.join(stuck)}. The motors move such joints "
        "only at creeping speed; lock them with locked={joint: value}, or raise limits={'effort': {joint: value}}."
    )


def locked_note(outside: Mapping[str, str], held: Mapping[str, float]) -> str:
    """Name the joints that are locked at positions outside their limits."""
    described = [text for joint, text in outside.items() if joint in held]
    return f"Locked outside the limits: {'; '.join(described)}." if described else ""


def neutral_note(outside: Mapping[str, str], name: str) -> str:
    """Name the reference of the neutral configuration and the joints that were moved inside their limits."""
    if not outside:
        return f"The neutral configuration is the reference {name!r}." if name else ""
    what = f"reference configuration {name!r}" if name else "zero configuration"
    described = "; ".join(outside.values())
    return f"The {what} lies outside the limits and was moved to the nearest: {described}."
