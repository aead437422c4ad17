"""To the planning model: continuous joints take an angle, some joints are locked.

Nothing here writes to the model it is given.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj.errors import InputError

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


def check_joints(model: pin.Model) -> None:
    """Refuse joints with more than one velocity, and active mimic joints.

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
    wide = [f"{n!r} ({j.shortname()})" for n, j in zip(model.names, model.joints, strict=True) if j.nv > 1]
    if wide:
        raise InputError(
            f"Joint {', '.join(wide)} has more than one degree of freedom; floating bases and spherical "
            "joints come "
            "with contacts. Give the model with a fixed root and single-axis joints."
        )


def plan_in_angles(model: pin.Model) -> pin.Model:
    """Copy a model, rebuilding each continuous joint (q = cos, sin) as a revolute one whose q is the angle.

    Joints and frames keep their order and placements, so geometry made for the model fits the copy. The
    angle of a rebuilt joint has no position limits: Pinocchio's +-1.01 bound its cosine and sine.
    """
    if model.nq == model.nv:
        return model.copy()
    copy = pin.Model()
    copy.name = model.name
    copy.gravity = model.gravity.copy()
    for i in range(1, model.njoints):
        joint = model.joints[i]
        angular = joint.nq != joint.nv
        v = slice(joint.idx_v, joint.idx_v + joint.nv)
        q = slice(joint.idx_q, joint.idx_q + joint.nq)
        lower = np.array([-np.inf]) if angular else model.lowerPositionLimit[q]
        upper = np.array([np.inf]) if angular else model.upperPositionLimit[q]
        effort, speed = model.upperEffortLimit[v], model.upperVelocityLimit[v]
        kind = _revolute(joint) if angular else joint
        copy.addJoint(model.parents[i], kind, model.jointPlacements[i], model.names[i], effort, speed, lower, upper)
        copy.appendBodyToJoint(i, model.inertias[i], pin.SE3.Identity())
    for frame in list(model.frames)[1:]:
        copy.addFrame(frame, False)
    for name in PER_VELOCITY:
        getattr(copy, name)[:] = getattr(model, name)
    copy.lowerEffortLimit[:] = model.lowerEffortLimit
    return copy


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
    result = np.zeros(model.nv)
    for joint in list(model.joints)[1:]:
        part = q[joint.idx_q : joint.idx_q + joint.nq]
        result[joint.idx_v] = part[0] if joint.nq == 1 else np.arctan2(part[1], part[0])
    return result


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
    names = [frame.name for frame in model.frames]
    links = {frame.name for frame in model.frames if frame.type == pin.FrameType.BODY}
    renamed = []
    for frame in model.frames:
        if frame.type in (pin.FrameType.JOINT, pin.FrameType.FIXED_JOINT) and frame.name in links:
            renamed.append(frame.name)
            while frame.name in names:
                frame.name += "_joint"
            names.append(frame.name)
    return renamed
