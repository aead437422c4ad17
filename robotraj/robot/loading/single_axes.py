"""Joints of several degrees of freedom as chains of joints with one each, which move, weigh and carry frames alike."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj.robot.loading.chain_names import Chains
from robotraj.robot.loading.planning_model import PER_VELOCITY, has_free_flyer

Part = tuple[str, pin.JointModel, pin.SE3]
"""Ending of the name, kind, and placement after the part before."""

_PX, _PY, _PZ = pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ
_RX, _RY, _RZ = pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ
CHAINS = {
    "JointModelPlanar": (("x", _PX), ("y", _PY), ("yaw", _RZ)),
    "JointModelTranslation": (("x", _PX), ("y", _PY), ("z", _PZ)),
    "JointModelSphericalZYX": (("yaw", _RZ), ("pitch", _RY), ("roll", _RX)),
    "JointModelSpherical": (("yaw", _RZ), ("pitch", _RY), ("roll", _RX)),
}
"""Joints that equal chains of joints along or about these axes, each after the ones before."""
ANGULAR = ("JointModelPlanar", "JointModelSpherical")
"""Joints whose angles are cosines, sines or quaternions in q, without position limits of their own."""

HELICAL = {"JointModelHX": (1.0, 0.0, 0.0), "JointModelHY": (0.0, 1.0, 0.0)}
"""Screws whose symbolic functions are not finite in Pinocchio 4.1; the one about any axis has the same motion."""


def single_axes(model: pin.Model) -> tuple[pin.Model, Chains]:
    """Return a model whose joints have one velocity each, except a free-flyer at its root, and the names of new joints.

    A planar joint ``base`` becomes ``base_x``, ``base_y`` and ``base_yaw``. A ball joint becomes ``_yaw``, ``_pitch``
    and ``_roll``, whose rates are not defined where the pitch is a quarter turn. A universal joint and a composite one
    become ``_1``, ``_2`` and so on. Screws about x or y become screws about an axis. The model itself is returned if it
    has no such joints, or another kind.
    """
    first = 2 if has_free_flyer(model) else 1
    kinds = {i: model.joints[i] for i in range(first, model.njoints)}
    parts = {i: _parts(joint) for i, joint in kinds.items() if joint.nv > 1 or joint.shortname() in HELICAL}
    if not parts or not all(parts.values()):
        return model, {}
    copy, moved = pin.Model(), {0: 0}
    copy.name, copy.gravity = model.name, model.gravity.copy()
    own: list[int] = []
    chains: dict[int, tuple[str, ...]] = {}
    for i in range(1, model.njoints):
        joint, name, parent = model.joints[i], model.names[i], moved[model.parents[i]]
        v, q = range(joint.idx_v, joint.idx_v + joint.nv), slice(joint.idx_q, joint.idx_q + joint.nq)
        low, high = model.lowerPositionLimit[q], model.upperPositionLimit[q]
        if joint.shortname() in ANGULAR:
            plain = 2 if joint.shortname() == "JointModelPlanar" else 0
            endless = np.full(3 - plain, np.inf)
            low, high = np.append(low[:plain], -endless), np.append(high[:plain], endless)
        chain = parts.get(i) or [("", joint, pin.SE3.Identity())]
        at_v = at_q = 0
        names: list[str] = []
        for ending, kind, placement in chain:
            full = f"{name}_{ending}" if ending else name
            where = model.jointPlacements[i] * placement if not names else placement
            of_v, of_q = list(v)[at_v : at_v + kind.nv], slice(at_q, at_q + kind.nq)
            efforts, speeds = model.upperEffortLimit[of_v], model.upperVelocityLimit[of_v]
            parent = copy.addJoint(parent, kind, where, full, efforts, speeds, low[of_q], high[of_q])
            at_v, at_q, names = at_v + kind.nv, at_q + kind.nq, [*names, full]
        moved[i] = parent
        own += list(v)
        chains[i] = tuple(names)
    for i, inertia in enumerate(model.inertias):
        copy.appendBodyToJoint(moved[i], inertia, pin.SE3.Identity())
    replaced = {model.names[i]: chains[i] for i in parts}
    _add_frames(model, copy, moved, replaced)
    for field in (*PER_VELOCITY, "lowerEffortLimit", "lowerVelocityLimit"):
        getattr(copy, field)[:] = getattr(model, field)[own]
    return copy, {joint: names for joint, names in replaced.items() if len(names) > 1}


def _add_frames(model: pin.Model, copy: pin.Model, moved: dict[int, int], chains: Chains) -> None:
    """Add the frames of a model to its copy in order; that of a replaced joint becomes one for each new joint."""
    numbers = {0: 0}
    for number, frame in enumerate(list(model.frames)[1:], start=1):
        kept = pin.Frame(frame)
        kept.parentJoint, kept.parentFrame = moved[frame.parentJoint], numbers.get(frame.parentFrame, 0)
        if frame.type == pin.FrameType.JOINT and frame.name in chains:
            *others, kept.name = chains[frame.name]
            for name in others:
                before = pin.Frame(name, copy.getJointId(name), kept.parentFrame, pin.SE3.Identity(), frame.type)
                kept.parentFrame = copy.addFrame(before, False)
        numbers[number] = copy.addFrame(kept, False)


def _parts(joint: pin.JointModel) -> list[Part]:
    """Return the chain of a joint; empty if its kind has none."""
    kind, still = joint.shortname(), pin.SE3.Identity()
    if kind in CHAINS:
        return [(ending, made(), still) for ending, made in CHAINS[kind]]
    if kind in HELICAL:
        return [("", pin.JointModelHelicalUnaligned(np.array(HELICAL[kind]), joint.extract().pitch), still)]
    if kind == "JointModelUniversal":
        universal = joint.extract()
        axes = (universal.axis1, universal.axis2)
        return [(str(k), pin.JointModelRevoluteUnaligned(np.array(axis)), still) for k, axis in enumerate(axes, 1)]
    if kind == "JointModelComposite":
        composite = joint.extract()
        inner = list(zip(composite.joints, composite.jointPlacements, strict=True))
        if any(part.nv != 1 for part, _ in inner):
            return []
        return [(str(k), part, pin.SE3(where)) for k, (part, where) in enumerate(inner, 1)]
    return []
