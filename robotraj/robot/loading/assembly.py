"""Assemble a Robot from a description: angles, locks, limits, neutral configuration, notes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.checks import names
from robotraj._util.errors import InputError, unknown_name, warn
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.coupling.mimics import Mimic, lock_mimics
from robotraj.robot.coupling.tightened_limits import tightened
from robotraj.robot.joint_limits.values import PositionLimits, RateLimits
from robotraj.robot.known_robots.makers import makers_note
from robotraj.robot.limits import BOUNDS, Limits
from robotraj.robot.loading.chain_names import Chains, chains_note, pitches, spread_names, spread_positions
from robotraj.robot.loading.geometry import Geometry, GivenGeometry
from robotraj.robot.loading.inertia import idle_joints, weightless_joints
from robotraj.robot.loading.notes import (
    dissipation_note,
    friction_note,
    idle_note,
    locked_note,
    mimic_note,
    neutral_note,
    renamed_frames_note,
    rest_note,
    spread_note,
    strength_note,
    weightless_note,
)
from robotraj.robot.loading.other_units import other_unit_note
from robotraj.robot.loading.planning_model import check_joints, names_of, reduced, rename_ambiguous_frames, with_angles
from robotraj.robot.loading.rotor import with_rotors
from robotraj.robot.loading.single_axes import single_axes
from robotraj.robot.loading.source import Description
from robotraj.robot.neutral import inside, outside, reference
from robotraj.robot.robot import Robot
from robotraj.robot.root import Root, carried, root_of, units_of, with_root
from robotraj.robot.sides.unlike_limits import sides_note

FRICTION_SHARE, FRICTION_SHARE_OF_LEGS = 1 / 640, 1 / 64
"""``friction_speed`` in shares of the highest speed limit of joints with friction.

Along an arm's motion, what the smooth friction leaves out of Coulomb's is then a thousandth of the objective. Robots on
a free root have wider friction, which their plans meet without softer friction before.
"""
SLOWEST_OF_LEGS, FASTEST_FRICTION = 0.05, 0.5
"""Bounds of ``friction_speed``, the lower one for a free root [rad/s, m/s]."""


def assemble(
    about: Description,
    actuated: Iterable[str] | None,
    locked: Mapping[str, float | Sequence[float]] | None,
    limits: Limits | Mapping[str, PositionLimits | RateLimits] | None,
    root: str = "fixed",
) -> Robot:
    """Return the robot.

    Raises
    ------
    InputError
        A joint is unknown or has several degrees of freedom, no joint moves, the limits are impossible, or the model
        cannot have the root.
    """
    stand = root_of(root)
    if not isinstance(about.geometry, tuple):  # shapes that were given are attached to the joints as they are
        single, chains = single_axes(about.model)
        about = replace(about, model=single, chains={**about.chains, **chains})
    check_joints(about.model)
    standing = with_root(about.model, root)
    if standing.njoints == 1:
        raise InputError(f"{about.name!r} has no moving joint: nothing to plan.")
    copy, armature_note = with_rotors(standing, about.srdf)
    whole = with_angles(copy)
    first, start = 1 + len(stand.joints), len(stand.positions)
    names = names_of(whole)[first:]
    q, reference_name = reference(about.model, about.srdf, root)
    every = _limits(whole, root, about)
    resting = inside(q, every)
    held = _locked(about, names, dict(zip(names, resting[start:], strict=True)), locked)
    _check_couplings(about.mimics, names)
    actuated = list(actuated) if isinstance(actuated, Iterable) and not isinstance(actuated, str) else actuated
    idle = _idle(about, whole, stand, resting, held, _named(actuated, limits))
    held |= idle
    ids = [i for i, joint in enumerate(names, start=first) if joint in held]
    if len(ids) == whole.njoints - 1:
        raise InputError(
            f"Every joint of {about.name!r} is locked ({', '.join(names)}): nothing can move. "
            "Joints that the URDF couples by <mimic> are locked together."
        )
    at = np.append(
        resting[:start], [held.get(joint, value) for joint, value in zip(names, resting[start:], strict=True)]
    )
    smaller = reduced(whole, ids, at)
    renamed = rename_ambiguous_frames(smaller)
    # Nothing was removed where no joint is locked.
    stated = _limits(smaller, root, about) if ids else every
    _check_dissipation(smaller, stated.joints)
    mimics = tuple(mimic for mimic in about.mimics if mimic.follower not in held)
    model = coupled(smaller, mimics)
    own = tightened(_in_order(stated, model), mimics)
    wanted = own if limits is None else own.override(limits)
    places = dict(zip(names, q[start:], strict=True))
    kept = np.append(q[:start], [places[joint] for joint in own.joints[own.free :]])
    motors = _actuated(actuated, about.actuated, own.joints[own.free :], mimics, about.chains)
    units = units_of(model, root)
    found = (
        weightless_note(weightless_joints(model)),
        idle_note(idle),
        strength_note(model, wanted, units, motors),
        spread_note(model),
        sides_note(own, wanted, units),
    )
    findings = (*about.findings, *filter(None, found))
    doubt = "" if limits is None else other_unit_note(own, wanted, units)
    warned = [text for text in (*(() if about.known else (*findings, *wanted.warnings(motors))), doubt) if text]
    if warned:
        warn(f"{about.name!r}: {' '.join(warned)}")
    friction = np.array(model.upperDryFrictionLimit)
    notes = (
        *findings,
        mimic_note(mimics),
        rest_note(about.mimics, held, locked or {}) if about.known else "",
        renamed_frames_note(renamed),
        chains_note(about.chains),
        armature_note,
        dissipation_note(model),
        friction_note(friction, wanted, units, motors),
        makers_note(about.name, wanted) if about.known else "",
        locked_note(outside(at, every, partial(units_of, whole, root)), held),
        neutral_note(outside(kept, wanted, lambda: units), reference_name),
    )
    return Robot(
        name=about.name,
        model=model,
        limits=wanted,
        actuated=motors,
        damping=np.array(model.damping),
        friction=friction,
        neutral=inside(kept, wanted),
        friction_speed=_friction_speed(friction, own.largest("velocity"), root),
        geometry=_geometry(about, whole, ids, at),
        origin=about.origin,
        end_effector=about.end_effector,
        notes=tuple(note for note in notes if note),
        root=root,
    )


def _limits(model: pin.Model, root: str, about: Description) -> Limits:
    """Return the limits of a model within those that its URDF states beside them, and those of balls' pitches."""
    own, stated = Limits.of(model, root), about.stated
    given = {
        quantity: {joint: pair for joint, pair in pairs.items() if joint in own.joints}
        for quantity, pairs in stated.pairs.items()
    }
    missing = tuple(joint for joint in stated.missing if joint in own.joints)
    return replace(own.override(given).override({"position": pitches(about.chains, own)}), missing=missing)


def _friction_speed(friction: Array, speeds: Array, root: str) -> float:
    """Return the width of dry friction, from the URDF's speed limits of the joints that have some."""
    rubbing = speeds[friction > 0.0]
    if root != "fixed":
        fastest = float(np.max(rubbing, initial=0.0))
        return float(np.clip(FRICTION_SHARE_OF_LEGS * fastest, SLOWEST_OF_LEGS, FASTEST_FRICTION))
    fastest = float(np.max(rubbing[np.isfinite(rubbing)], initial=0.0))
    return float(np.clip(FRICTION_SHARE * fastest, Robot.friction_speed, FASTEST_FRICTION))


def _locked(
    about: Description,
    names: Sequence[str],
    resting: Mapping[str, float],
    locked: Mapping[str, float | Sequence[float]] | None,
) -> dict[str, float]:
    """Return the locked joints with their positions: the caller's, the catalogue's, and those coupled by <mimic>."""
    if locked is not None and not isinstance(locked, Mapping):
        raise InputError(f"locked= is a mapping such as {{'wrist': 0.0}}; got {locked!r}.")
    asked = spread_positions(locked or {}, about.chains)
    for joint, value in asked.items():
        if joint not in names:  # pin.buildReducedModel would ignore it
            raise unknown_name("joint", joint, names, "Correct the name in locked=.")
        if not isinstance(value, (int, float, np.number)) or not np.isfinite(value):
            raise InputError(f"locked= holds joint {joint!r} at {value!r}; give one finite number [rad, m].")
    if about.moving:
        still = [joint for joint in names if not joint.startswith(about.moving)]
        asked = {joint: resting[joint] for joint in still} | asked
    if about.known:
        heads = {mimic.leader for mimic in about.mimics} - set(asked)
        asked |= {
            leader: resting[leader] for leader in heads if not any(_leads(m, leader, asked) for m in about.mimics)
        }
    return lock_mimics(about.mimics, asked)


def _idle(
    about: Description,
    whole: pin.Model,
    stand: Root,
    resting: Array,
    held: Mapping[str, float],
    named: Collection[str],
) -> dict[str, float]:
    """Return the joints of a free root that move no mass, with their positions at rest, unless the caller names them.

    Such a robot is planned by its dynamics, whose mass matrix would be singular. Coupled joints are left as they are.
    """
    if not stand.joints:
        return {}
    places = dict(zip(names_of(whole)[1 + len(stand.joints) :], resting[len(stand.positions) :], strict=True))
    at = np.append(resting[: len(stand.positions)], [held.get(joint, place) for joint, place in places.items()])
    kept = {*named, *(joint for mimic in about.mimics for joint in (mimic.leader, mimic.follower))}
    return {joint: places[joint] for joint in idle_joints(whole, at, len(stand.velocities), held, kept)}


def _named(
    actuated: Iterable[str] | None, limits: Limits | Mapping[str, PositionLimits | RateLimits] | None
) -> set[str]:
    """Return the joints that the caller names."""
    given = limits.values() if isinstance(limits, Mapping) else ()
    joints = {joint for each in given if isinstance(each, Mapping) for joint in each}
    # What is no list of names is refused where it is read.
    driven = {each for each in actuated if isinstance(each, str)} if isinstance(actuated, Iterable) else set()
    return joints | (set(limits.joints) if isinstance(limits, Limits) else set()) | driven


def _leads(mimic: Mimic, leader: str, asked: Mapping[str, float]) -> bool:
    """Whether a locked follower determines the position of its leader."""
    return mimic.leader == leader and mimic.follower in asked


def _check_couplings(mimics: Sequence[Mimic], names: Sequence[str]) -> None:
    """Check that coupled joints have one degree of freedom each: others are chains of joints with other names."""
    for mimic in mimics:
        wide = next((joint for joint in (mimic.leader, mimic.follower) if joint not in names), None)
        if wide is not None:
            raise InputError(
                f"Joint {mimic.follower!r} mimics {mimic.leader!r}, but {wide!r} has several degrees of freedom; "
                "remove its <mimic>."
            )


def _in_order(limits: Limits, model: pin.Model) -> Limits:
    """Return the limits in the order of a model's joints."""
    names = dict.fromkeys((*limits.joints[: limits.free], *names_of(model)[1:]))
    order = [limits.joints.index(joint) for joint in names if joint in limits.joints]
    sides = {name: getattr(limits, name)[order] for name in BOUNDS}
    joints = tuple(limits.joints[i] for i in order)
    return replace(limits, joints=joints, **sides)


def _actuated(
    asked: Iterable[str] | None,
    default: tuple[str, ...] | None,
    joints: tuple[str, ...],
    mimics: Sequence[Mimic],
    chains: Chains,
) -> tuple[str, ...]:
    """Return the joints with a motor, in the order of v."""
    if asked is None:
        return joints if default is None else tuple(joint for joint in joints if joint in default)
    if isinstance(asked, str):
        raise InputError(f"actuated= is a list of joint names, such as [{asked!r}]; got {asked!r}.")
    wanted = spread_names(names("actuated=", asked), chains)
    leaders = {mimic.follower: mimic.leader for mimic in mimics}
    for joint in wanted:
        if joint in leaders:
            raise InputError(
                f"actuated= names {joint!r}, which moves with {leaders[joint]!r}: one motor drives both. "
                "Name the leader."
            )
        if joint not in joints:
            raise unknown_name("moving joint", joint, joints, "Correct the name in actuated=.")
    return tuple(joint for joint in joints if joint in wanted)


def _geometry(about: Description, whole: pin.Model, ids: Sequence[int], at: Array) -> Geometry:
    if isinstance(about.geometry, tuple):
        visual, collision = about.geometry
        before = whole.njoints - about.model.njoints
        return GivenGeometry(whole, carried(visual, before), carried(collision, before), tuple(ids), at)
    return about.geometry


def _check_dissipation(model: pin.Model, joints: Sequence[str]) -> None:
    for what, values in (("damping", model.damping), ("friction", model.upperDryFrictionLimit)):
        for joint, value in zip(joints, values, strict=True):
            if not value >= 0 or np.isinf(value):
                raise InputError(f"Joint {joint!r} has {what} {value:g}; it must be a number of at least 0.")
