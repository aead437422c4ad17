"""To the planning model: continuous joints take an angle, some joints are locked, a root is put before.

Nothing here writes to the model it is given.
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
"""Marks links for a moment; no URDF name holds a line break."""

PER_VELOCITY = (
    "armature",
    "rotorInertia",
    "rotorGearRatio",
    "damping",
    "upperDryFrictionLimit",
    "lowerDryFrictionLimit",
)


def names_of(model: pin.Model) -> list[str]:
    """Give the names of all joints, the universe first; Pinocchio's own iterator ends by an exception of C++."""
    names = model.names
    return [names[joint] for joint in range(model.njoints)]


def check_joints(model: pin.Model) -> None:
    """Refuse active mimic joints, and joints with more than one velocity but for a free-flyer at the root.

    Raises
    ------
    InputError
        Names the joints, and says what to give instead.
    """
    mimic = [model.names[joint] for joint in model.mimicking_joints]
    if mimic:
        raise InputError(
            f"The model has active mimic joints ({', '.join(mimic)}), which Pinocchio's forward dynamics "
            "refuses; "
            "give the path of the URDF, or build the model with mimic=False (the joints are then "
            "independent)."
        )
    first = 2 if flies(model) else 1
    rigid = enumerate(model.joints.tolist()[first:], start=first)
    wide = [f"{model.names[i]!r} ({joint.shortname()})" for i, joint in rigid if joint.nv > 1]
    if wide:
        raise InputError(
            f"Joint {', '.join(wide)} has more than one degree of freedom. Give a model with single-axis joints; one "
            "that moves freely is loaded with its root fixed in the file and root='floating' or root='planar'."
        )


def flies(model: pin.Model) -> bool:
    """Whether the model's first joint is a free-flyer on the universe."""
    return model.njoints > 1 and model.joints[1].shortname() == "JointModelFreeFlyer"


def plan_in_angles(model: pin.Model) -> pin.Model:
    """Copy a model, rebuilding each continuous joint (q = cos, sin) as a revolute one whose q is the angle.

    Joints and frames keep their order and placements, so geometry made for the model fits the copy. The
    angle of a rebuilt joint has no position limits: Pinocchio's +-1.01 bound its cosine and sine.
    """
    return rebuilt(model, in_angles=True) if any(map(_circles, model.joints.tolist())) else model.copy()


def rebuilt(model: pin.Model, before: Sequence[tuple[str, pin.JointModel]] = (), in_angles: bool = False) -> pin.Model:
    """Build a model again: with named joints in a chain before its root link, or with angles of continuous joints.

    Pinocchio's own ``appendModel`` would lose the armature and the order of the frames.
    """
    n = len(before)
    copy = pin.Model()
    copy.name = model.name
    copy.gravity = model.gravity.copy()
    for parent, (name, kind) in enumerate(before):
        copy.addJointFrame(copy.addJoint(parent, kind, pin.SE3.Identity(), name))
    for i in range(1, model.njoints):
        joint = model.joints[i]
        angular = in_angles and _circles(joint)
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
    for name in (*PER_VELOCITY, "lowerEffortLimit"):
        getattr(copy, name)[own] = getattr(model, name)
    return copy


def _circles(joint: pin.JointModel) -> bool:
    """Whether a joint's position is the cosine and sine of its angle."""
    return bool(joint.nq == 2 and joint.nv == 1)


def _revolute(joint: pin.JointModel) -> pin.JointModel:
    if joint.shortname() in ALIGNED:
        return ALIGNED[joint.shortname()]()
    data = joint.createData()
    joint.calc(data, np.array([1.0, 0.0]))
    return pin.JointModelRevoluteUnaligned(np.asarray(data.S).reshape(6)[3:])


def angles(model: pin.Model, q: Array) -> Array:
    """Turn a configuration of ``model`` into one of ``plan_in_angles(model)``: atan2(sin, cos).

    A pair (cos, sin) need not have length 1; one of length 0 gives the angle 0.
    """
    parts = [np.zeros(0)]
    for joint in model.joints.tolist()[1:]:
        part = q[joint.idx_q : joint.idx_q + joint.nq]
        parts.append(np.arctan2(part[1:], part[:1]) if _circles(joint) else part)
    return np.concatenate(parts)


def reduced(model: pin.Model, ids: list[int], q: Array) -> pin.Model:
    """Copy a model with joints locked where configuration q has them; their frames stay, as fixed ones.

    Links that are named like a joint are renamed meanwhile: Pinocchio 4.1 refuses to choose between the two.
    """
    copy = model.copy()
    if not ids:
        return copy
    twins = [frame for frame in copy.frames if frame.type == pin.FrameType.BODY and frame.name in model.names]
    for frame in twins:
        frame.name += LINK_MARK
    smaller = pin.buildReducedModel(copy, ids, q)
    for frame in smaller.frames:
        frame.name = frame.name.removesuffix(LINK_MARK)
    return smaller


def tell_frames_apart(model: pin.Model) -> list[str]:
    """Rename, in place, joint frames named like a link, ``pole`` to ``pole_joint``; give the old names.

    Pinocchio 4.1 raises for an ambiguous name wherever a frame is looked up. The link keeps its name: it is
    what people mean, and both frames are in the same place.
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
