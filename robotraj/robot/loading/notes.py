"""Notes on decisions made while loading, one sentence each; a note without a decision is empty."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.limits import Limits
from robotraj.robot.size.reach import reach

GRAVITY = 9.81
THINNEST = 1e-4
"""Mass over the cube of the reach [kg/m^3] below which lengths are doubted: arms have 1 to 100, tall cranes 0.01, and a
billionth of that in mm. Air has 1.2."""
STRONGEST = 20.0
"""Effort relative to the robot's weight at its full reach above which a limit is implausible; real arms reach 0.2 to 4,
small grippers 9."""


def mimic_note(mimics: Sequence[Mimic]) -> str:
    """Name the joints that follow others."""
    if not mimics:
        return ""
    return (
        f"Joints that move with a leader have no entries in q and v: {', '.join(map(str, mimics))}. "
        "The leader's limits lie within theirs, and its motor drives them."
    )


def rest_note(mimics: Sequence[Mimic], held: Mapping[str, float], asked: Collection[str]) -> str:
    """Name the coupled joints of a robot in the catalogue that were locked by default."""
    coupled = {joint for mimic in mimics for joint in (mimic.leader, mimic.follower)} - set(asked)
    places = ", ".join(f"{joint} at {held[joint]:.4g}" for joint in held if joint in coupled)
    if not places:
        return ""
    return (
        f"Joints coupled by <mimic> are locked: {places}. Choose where with locked={{leader: value}}, "
        "or load the URDF by its path to move them."
    )


def weightless_note(joints: Sequence[str]) -> str:
    """Name the joints that move neither mass nor inertia."""
    if not joints:
        return ""
    return (
        f"No mass moves with {', '.join(map(repr, joints))}, so the mass matrix is singular. Give the links an "
        "<inertial>, or lock the joints with locked={joint: value}."
    )


def idle_note(joints: Mapping[str, float]) -> str:
    """Name the joints that are locked since they move no mass."""
    if not joints:
        return ""
    places = ", ".join(f"{joint} at {value:.4g}" for joint, value in joints.items())
    return (
        f"Joints that move no mass, alone or together, are locked: {places}. Give the links an <inertial> to move them."
    )


def strength_note(model: pin.Model, limits: Limits, units: Sequence[str], actuated: Collection[str]) -> str:
    """Name joints whose effort limit is implausible beside the weight of the whole robot at its full reach."""
    weight = GRAVITY * sum(body.mass for body in model.inertias.tolist()[1:])
    span, efforts = reach(model), limits.largest("effort")
    strong = [
        f"{joint} ({efforts[i]:.4g} {'N' if unit == 'm' else 'N m'})"
        for i, (joint, unit) in enumerate(zip(limits.joints, units, strict=True))
        if joint in actuated
        and np.isfinite(efforts[i])
        and efforts[i] > STRONGEST * weight * (1.0 if unit == "m" else span)
    ]
    if not strong or weight == 0.0:
        return ""
    more = f" and {len(strong) - 1} more" if len(strong) > 1 else ""
    return (
        f"Implausible effort limit of {strong[0]}{more}: the robot weighs {weight / GRAVITY:.3g} kg and reaches "
        f"{span:.2g} m. No motion needs as much, so this limit never holds one back; give the motors' own with "
        "limits={'effort': ...}."
    )


def spread_note(model: pin.Model) -> str:
    """Name a reach that no robot of that mass has: lengths in millimetres, mostly."""
    mass, span = sum(body.mass for body in model.inertias.tolist()[1:]), reach(model)
    if not 0.0 < mass < THINNEST * span**3:
        return ""
    return (
        f"The robot weighs {mass:.4g} kg and reaches {span:.4g} m, as if its lengths were in mm. A URDF's are in m, "
        "its inertias in kg m^2: correct the file."
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
        "Damping and friction come from the model (a URDF's <dynamics>). robotraj adds them to Pinocchio's dynamics, "
        "which ignore them."
    )


def friction_note(friction: Array, limits: Limits, units: Sequence[str], actuated: Collection[str]) -> str:
    """Name the joints whose friction is as large as their effort limit."""
    efforts = limits.largest("effort")
    stuck = [
        f"{joint} ({friction[i]:.4g} of {efforts[i]:.4g} {'N' if units[i] == 'm' else 'N m'})"
        for i, joint in enumerate(limits.joints)
        if joint in actuated and friction[i] > 0 and friction[i] >= efforts[i]
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
