"""Steps from the model as read to the planning model: angles of continuous joints, locked joints, a moving root.

No function but ``rename_ambiguous_frames`` changes its argument.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError

ALIGNED = {
    "JointModelRUBX": pin.JointModelRX,
    "JointModelRUBY": pin.JointModelRY,
    "JointModelRUBZ": pin.JointModelRZ,
}
LINK_MARK = "\n(link)"
"""Temporary mark of links; names in a URDF contain no line break."""

PER_VELOCITY = (
    "armature",
    "rotorInertia",
    "rotorGearRatio",
    "damping",
    "upperDryFrictionLimit",
    "lowerDryFrictionLimit",
)


def names_of(model: pin.Model) -> list[str]:
    """Return the names of all joints, the universe first; Pinocchio's iterators end by a slow C++ exception."""
    names = model.names
    return [names[joint] for joint in range(model.njoints)]


def independent_names(model: pin.Model) -> list[str]:
    """Return the names of the joints that follow no other, without the universe."""
    names = names_of(model)[1:]
    if not len(model.mimicking_joints):
        return names
    return [name for i, name in enumerate(names, start=1) if model.joints[i].nv]


def parents_of(model: pin.Model) -> list[int]:
    """Return the number of every joint's parent; that of the universe is 0."""
    parents = model.parents
    return [int(parents[joint]) for joint in range(model.njoints)]


def check_joints(model: pin.Model) -> None:
    """Check that all joints but a free-flyer at the root have one velocity.

    Raises
    ------
    InputError
        Names the joints and the remedy.
    """
    first = 2 if has_free_flyer(model) else 1
    rigid = enumerate(model.joints.tolist()[first:], start=first)
    wide = [f"{model.names[i]!r} ({joint.shortname()})" for i, joint in rigid if joint.nv > 1]
    if wide:
        raise InputError(
            f"Joint {', '.join(wide)} has more than one degree of freedom, of a kind that has no chain of single ones. "
            "One that moves freely is loaded with its root fixed in the file and root='floating' or root='planar'."
        )


def has_free_flyer(model: pin.Model) -> bool:
    """Whether the model's first joint is a free-flyer on the universe."""
    return model.njoints > 1 and model.joints[1].shortname() == "JointModelFreeFlyer"


def with_angles(model: pin.Model) -> pin.Model:
    """Return a copy whose continuous joints (q = cos, sin) are revolute joints with the angle as q.

    Joints and frames keep their order and placements, so that geometry of the model fits the copy. The new joints have
    no position limits: Pinocchio's limits of +-1.01 apply to cosine and sine.
    """
    return rebuilt(model, in_angles=True) if any(map(_is_continuous, model.joints.tolist())) else model.copy()


def rebuilt(
    model: pin.Model,
    before: Sequence[tuple[str, pin.JointModel]] = (),
    in_angles: bool = False,
    order: Sequence[int] | None = None,
) -> pin.Model:
    """Return a copy with a chain of named joints before the root link, with angles of continuous joints, or in order.

    Joints that follow others become independent, without limits, damping or armature. Frames keep their order.
    Pinocchio's ``appendModel`` loses the armature and the order of the frames.

    Parameters
    ----------
    model : pinocchio.Model
    before : sequence of (str, pinocchio.JointModel)
        The chain.
    in_angles : bool
        Whether continuous joints become revolute ones.
    order : sequence of int, optional
        The joints without the universe, parents before children; that of the model by default.
    """
    n, order = len(before), range(1, model.njoints) if order is None else order
    copy = pin.Model()
    copy.name = model.name
    copy.gravity = model.gravity.copy()
    for parent, (name, kind) in enumerate(before):
        copy.addJointFrame(copy.addJoint(parent, kind, pin.SE3.Identity(), name))
    moved, first = {0: n}, copy.nv
    for i in order:
        joint = model.joints[i]
        angular = in_angles and _is_continuous(joint)
        v = slice(joint.idx_v, joint.idx_v + joint.nv)
        q = slice(joint.idx_q, joint.idx_q + joint.nq)
        follows = joint.nv == 0
        limited = not angular and not follows
        lower = model.lowerPositionLimit[q] if limited else np.array([-np.inf])
        upper = model.upperPositionLimit[q] if limited else np.array([np.inf])
        rates = (np.array([np.inf]),) * 2 if follows else (model.upperEffortLimit[v], model.upperVelocityLimit[v])
        kind = _revolute(joint) if angular else independent_joint(model, i) if follows else joint
        parent = moved[model.parents[i]]
        moved[i] = copy.addJoint(parent, kind, model.jointPlacements[i], model.names[i], *rates, lower, upper)
    for i, inertia in enumerate(model.inertias):
        copy.appendBodyToJoint(moved[i], inertia, pin.SE3.Identity())
    for frame in list(model.frames)[1:]:
        changed = pin.Frame(frame)
        changed.parentJoint = moved[frame.parentJoint]
        changed.parentFrame += n
        copy.addFrame(changed, False)
    for name in (*PER_VELOCITY, "lowerEffortLimit", "lowerVelocityLimit"):
        old, new, at = getattr(model, name), getattr(copy, name), first
        for joint in (model.joints[i] for i in order):
            if joint.nv:
                new[at : at + joint.nv] = old[joint.idx_v : joint.idx_v + joint.nv]
            at += joint.nv or 1
    return copy


def _is_continuous(joint: pin.JointModel) -> bool:
    """Whether a joint's position is the cosine and sine of its angle."""
    return bool(joint.nq == 2 and joint.nv == 1)


def independent_joint(model: pin.Model, i: int) -> pin.JointModel:
    """Return the joint that a mimic joint is but for its leader."""
    joint = model.joints[i]
    data = joint.createData()
    joint.calc(data, pin.neutral(model))
    axis = np.asarray(data.S).reshape(6) / joint.extract().scaling
    linear, angular = axis[:3], axis[3:]
    turns = bool(np.linalg.norm(angular) > 0.5)
    for letter, unit in zip("XYZ", np.eye(3), strict=True):
        if np.array_equal(angular if turns else linear, unit):
            return pin.JointModel(getattr(pin, f"JointModel{'R' if turns else 'P'}{letter}")())
    unaligned = pin.JointModelRevoluteUnaligned if turns else pin.JointModelPrismaticUnaligned
    return pin.JointModel(unaligned(angular if turns else linear))


def _revolute(joint: pin.JointModel) -> pin.JointModel:
    if joint.shortname() in ALIGNED:
        return ALIGNED[joint.shortname()]()
    data = joint.createData()
    joint.calc(data, np.array([1.0, 0.0]))
    return pin.JointModelRevoluteUnaligned(np.asarray(data.S).reshape(6)[3:])


def angles(model: pin.Model, q: Array) -> Array:
    """Return the configuration of ``with_angles(model)`` for one of ``model``: atan2(sin, cos).

    A pair (cos, sin) may have any length; the angle of a zero pair is 0.
    """
    parts = [np.zeros(0)]
    for joint in model.joints.tolist()[1:]:
        part = q[joint.idx_q : joint.idx_q + joint.nq]
        parts.append(np.arctan2(part[1:], part[:1]) if _is_continuous(joint) else part)
    return np.concatenate(parts)


def reduced(model: pin.Model, ids: list[int], q: Array) -> pin.Model:
    """Return a copy with joints locked at configuration q; their frames become fixed.

    Links with the name of a joint are renamed during the call: Pinocchio 4.1 raises for ambiguous names. Locked joints
    without a frame get one: without it the process would abort.
    """
    copy = model.copy()
    if not ids:
        return copy
    framed = {frame.parentJoint for frame in copy.frames if frame.type == pin.FrameType.JOINT}
    for joint in ids:
        if joint not in framed:
            copy.addJointFrame(joint)
    ambiguous = [frame for frame in copy.frames if frame.type == pin.FrameType.BODY and frame.name in model.names]
    for frame in ambiguous:
        frame.name += LINK_MARK
    smaller = pin.buildReducedModel(copy, ids, q)
    for frame in smaller.frames:
        frame.name = frame.name.removesuffix(LINK_MARK)
    return smaller


def rename_ambiguous_frames(model: pin.Model) -> list[str]:
    """Rename joint frames with the name of a link in place, ``pole`` to ``pole_joint``, and return the old names.

    Pinocchio 4.1 raises when a frame is looked up by an ambiguous name. The link keeps its name; both frames coincide.
    """
    frames = model.frames.tolist()
    names = [frame.name for frame in frames]
    if len(set(names)) == len(names):
        return []
    links = {name for frame, name in zip(frames, names, strict=True) if frame.type == pin.FrameType.BODY}
    renamed = []
    for frame in frames:
        if frame.type in (pin.FrameType.JOINT, pin.FrameType.FIXED_JOINT) and frame.name in links:
            renamed.append(frame.name)
            while frame.name in names:
                frame.name += "_joint"
            names.append(frame.name)
    return renamed
