"""Steps from the model as read to the planning model: angles of continuous joints, locked joints, a moving root.

No function but ``rename_ambiguous_frames`` changes its argument.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.errors import InputError

Array = npt.NDArray[np.float64]

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


def parents_of(model: pin.Model) -> list[int]:
    """Return the number of every joint's parent; that of the universe is 0."""
    parents = model.parents
    return [int(parents[joint]) for joint in range(model.njoints)]


def check_joints(model: pin.Model) -> None:
    """Check that no joint is an active mimic joint and that all but a free-flyer at the root have one velocity.

    Raises
    ------
    InputError
        Names the joints and the remedy.
    """
    mimic = [model.names[model.mimicking_joints[i]] for i in range(len(model.mimicking_joints))]
    if mimic:
        raise InputError(
            f"The model has active mimic joints ({', '.join(mimic)}), which Pinocchio's forward dynamics does not "
            "support. Give the path of the URDF, or build the model with mimic=False, which makes them independent."
        )
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


def rebuilt(model: pin.Model, before: Sequence[tuple[str, pin.JointModel]] = (), in_angles: bool = False) -> pin.Model:
    """Return a copy with a chain of named joints before the root link, or with angles of continuous joints.

    Pinocchio's ``appendModel`` loses the armature and the order of the frames.
    """
    n = len(before)
    copy = pin.Model()
    copy.name = model.name
    copy.gravity = model.gravity.copy()
    for parent, (name, kind) in enumerate(before):
        copy.addJointFrame(copy.addJoint(parent, kind, pin.SE3.Identity(), name))
    for i in range(1, model.njoints):
        joint = model.joints[i]
        angular = in_angles and _is_continuous(joint)
        v = slice(joint.idx_v, joint.idx_v + joint.nv)
        q = slice(joint.idx_q, joint.idx_q + joint.nq)
        lower = np.array([-np.inf]) if angular else model.lowerPositionLimit[q]
        upper = np.array([np.inf]) if angular else model.upperPositionLimit[q]
        effort, speed = model.upperEffortLimit[v], model.upperVelocityLimit[v]
        kind = _revolute(joint) if angular else joint
        parent = model.parents[i] + n
        copy.addJoint(parent, kind, model.jointPlacements[i], model.names[i], effort, speed, lower, upper)
    for i, inertia in enumerate(model.inertias):
        copy.appendBodyToJoint(i + n, inertia, pin.SE3.Identity())
    for frame in list(model.frames)[1:]:
        moved = pin.Frame(frame)
        moved.parentJoint += n
        moved.parentFrame += n
        copy.addFrame(moved, False)
    own = slice(copy.nv - model.nv, copy.nv)
    for name in (*PER_VELOCITY, "lowerEffortLimit", "lowerVelocityLimit"):
        getattr(copy, name)[own] = getattr(model, name)
    return copy


def _is_continuous(joint: pin.JointModel) -> bool:
    """Whether a joint's position is the cosine and sine of its angle."""
    return bool(joint.nq == 2 and joint.nv == 1)


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

    Links with the name of a joint are renamed during the call: Pinocchio 4.1 raises for ambiguous names.
    """
    copy = model.copy()
    if not ids:
        return copy
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
