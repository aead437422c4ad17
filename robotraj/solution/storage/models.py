"""Pinocchio's models as checked names and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.coupling.mimics import mimics_of
from robotraj.robot.loading.planning_model import independent_joint
from robotraj.solution.storage.plain_data import Json

T = TypeVar("T")

JOINTS = 1000
"""Largest number of joints of a model in a file."""

FRAMES = 100_000
"""Largest number of frames of a model in a file."""

PARAMETERS = {
    **{f"JointModel{kind}{axis}": () for kind in ("R", "P", "RUB") for axis in "XYZ"},
    **{f"JointModelH{axis}": ("pitch",) for axis in "XYZ"},
    **{f"JointModel{kind}": () for kind in ("FreeFlyer", "Planar", "Spherical", "SphericalZYX", "Translation")},
    **{f"JointModel{kind}Unaligned": ("axis",) for kind in ("Revolute", "Prismatic", "RevoluteUnbounded")},
    "JointModelHelicalUnaligned": ("axis", "pitch"),
    "JointModelUniversal": ("axis1", "axis2"),
}
"""Arguments of the constructors of the joints that a file may hold."""

FOLLOWER = "JointModelMimic"

VECTORS = (
    "armature",
    "damping",
    "lowerDryFrictionLimit",
    "upperDryFrictionLimit",
    "lowerEffortLimit",
    "upperEffortLimit",
    "lowerVelocityLimit",
    "upperVelocityLimit",
    "rotorInertia",
    "rotorGearRatio",
    "lowerPositionLimit",
    "upperPositionLimit",
    "positionLimitMargin",
)
"""Vectors of a model, (nv,) or (nq,)."""


def model_data(model: pin.Model) -> dict[str, object]:
    """Return a model as names, whole numbers and arrays.

    Raises
    ------
    ValueError
        A joint is of a type that files do not hold.
    """
    joints = range(1, model.njoints)
    followers = {
        mimic.follower: {
            "kind": FOLLOWER,
            "leader": mimic.leader,
            "multiplier": mimic.multiplier,
            "offset": mimic.offset,
            "joint": _joint_data(independent_joint(model, model.getJointId(mimic.follower))),
        }
        for mimic in mimics_of(model)
    }
    return {
        "name": model.name,
        "joints": [followers.get(model.names[i]) or _joint_data(model.joints[i]) for i in joints],
        "joint_names": [model.names[i] for i in joints],
        "parents": [int(model.parents[i]) for i in joints],
        "placements": np.array([_placement(model.jointPlacements[i]) for i in joints]).reshape(-1, 12),
        "inertias": np.array([_inertia(model.inertias[i]) for i in range(model.njoints)]),
        "frames": [
            [frame.name, int(frame.parentJoint), int(frame.parentFrame), int(frame.type)] for frame in model.frames[1:]
        ],
        "frame_placements": np.array([_placement(frame.placement) for frame in model.frames[1:]]).reshape(-1, 12),
        "frame_inertias": np.array([_inertia(frame.inertia) for frame in model.frames[1:]]).reshape(-1, 10),
        "bodies": int(model.nbodies),
        "vectors": {name: np.array(getattr(model, name)) for name in VECTORS},
        "gravity": np.array(model.gravity.linear),
        "references": {entry.key(): np.array(entry.data()) for entry in model.referenceConfigurations},
    }


def model_of(data: Mapping[str, object]) -> pin.Model:
    """Make a model from what ``model_data`` returned.

    Raises
    ------
    ValueError
        Names, sizes or numbers that are none of a model; the message names it.
    """
    names, parents, joints = (_entries(data, key, JOINTS) for key in ("joint_names", "parents", "joints"))
    placements, count = _array(data, "placements", (len(joints), 12)), len(joints) + 1
    _require(len(names) == len(parents) == len(joints), "joints, their names and their parents differ in number")
    _require(all(isinstance(name, str) for name in names), "a joint's name is no text")
    _require(len({*names, "universe"}) == count, "two joints have one name")
    model = pin.Model()
    model.name = _of_kind(data.get("name"), str, "name")
    for i, (name, parent, joint) in enumerate(zip(names, parents, joints, strict=True)):
        _require(type(parent) is int and 0 <= parent <= i, f"joint {name!r} has no parent before it")
        model.addJoint(parent, _joint_of(joint), _se3(placements[i]), name)
    model = _following(model, {name: joint for name, joint in zip(names, joints, strict=True) if _follows(joint)})
    bodies = _of_kind(data.get("bodies"), int, "bodies")
    _require(0 < bodies <= FRAMES, "the number of bodies is none")
    for _ in range(1, bodies):
        # Pinocchio counts bodies where they are appended; the inertias follow.
        model.appendBodyToJoint(0, pin.Inertia.Zero(), pin.SE3.Identity())
    for i, numbers in enumerate(_array(data, "inertias", (count, 10))):
        model.inertias[i] = _inertia_of(numbers)
    frames = _entries(data, "frames", FRAMES)
    placements = _array(data, "frame_placements", (len(frames), 12))
    inertias = _array(data, "frame_inertias", (len(frames), 10))
    for i, frame in enumerate(frames):
        _require(isinstance(frame, list) and len(frame) == 4, "a frame is not a name and three numbers")
        name, joint, before, kind = frame
        _require(isinstance(name, str), "a frame's name is no text")
        _require(type(joint) is int and 0 <= joint < count, f"frame {name!r} has no joint")
        _require(type(before) is int and 0 <= before <= len(frames), f"frame {name!r} has no parent")
        _require(kind in pin.FrameType.values, f"frame {name!r} is of no known type")
        made = pin.Frame(
            name, joint, min(before, i), _se3(placements[i]), pin.FrameType.values[kind], _inertia_of(inertias[i])
        )
        model.addFrame(made, False)
        # A reduced model has frames whose parents stand behind them.
        model.frames[i + 1].parentFrame = before
    _require(model.nframes == len(frames) + 1, "two frames of one type have one name")
    vectors = _of_kind(data.get("vectors"), dict, "vectors")
    for name in VECTORS:
        setattr(model, name, _array(vectors, name, np.shape(getattr(model, name)), infinite=True))
    model.gravity.linear = _array(data, "gravity", (3,))
    for name, q in _of_kind(data.get("references"), dict, "references").items():
        model.referenceConfigurations[name] = _array({name: q}, name, (model.nq,))
    return model


def _joint_data(joint: pin.JointModel) -> dict[str, object]:
    kind = joint.shortname()
    if kind == "JointModelComposite":
        composite = joint.extract()
        placements = np.array([_placement(where) for where in composite.jointPlacements])
        return {"kind": kind, "parts": [_joint_data(part) for part in composite.joints], "placements": placements}
    if kind not in PARAMETERS:
        raise ValueError(f"a joint is a {kind}")
    inner = joint.extract()
    return {"kind": kind, **{name: np.array(getattr(inner, name), dtype=float) for name in PARAMETERS[kind]}}


def _follows(joint: object) -> bool:
    return isinstance(joint, dict) and joint.get("kind") == FOLLOWER


def _following(model: pin.Model, followers: Mapping[str, Json]) -> pin.Model:
    """Let joints follow their leaders."""
    for name, entry in followers.items():
        leader = _of_kind(entry.get("leader"), str, "leader")
        multiplier, offset = (_of_kind(entry.get(key), float, key) for key in ("multiplier", "offset"))
        known = leader not in followers and leader in list(model.names)[1:]
        _require(known and model.getJointId(leader) < model.getJointId(name), f"{name!r} has no leader before it")
        _require(model.joints[model.getJointId(leader)].nq == 1, f"{leader!r} leads with several positions")
        _require(bool(np.isfinite([multiplier, offset]).all()) and multiplier != 0.0, f"{name!r} does not follow")
        model = pin.transformJointIntoMimic(model, model.getJointId(leader), model.getJointId(name), multiplier, offset)
    return model


def _joint_of(data: object, nested: bool = False) -> pin.JointModel:
    entry = _of_kind(data, dict, "joint")
    if _follows(entry) and not nested:
        independent = _joint_of(entry.get("joint"), nested=True)
        _require(independent.nq == 1, "a follower has several positions")
        return independent
    kind = _of_kind(entry.get("kind"), str, "kind")
    if kind == "JointModelComposite" and not nested:
        parts = _entries(entry, "parts", 100)
        placements = _array(entry, "placements", (len(parts), 12))
        composite = pin.JointModelComposite(len(parts))
        for part, where in zip(parts, placements, strict=True):
            composite.addJoint(_joint_of(part, nested=True), _se3(where))
        return composite
    _require(kind in PARAMETERS, f"there is no joint of the kind {kind!r}")
    arguments = []
    for name in PARAMETERS[kind]:
        value = _array(entry, name, () if name == "pitch" else (3,))
        _require(name == "pitch" or abs(float(np.linalg.norm(value)) - 1.0) < 1e-6, "an axis is no unit vector")
        arguments.append(float(value) if name == "pitch" else value)
    return getattr(pin, kind)(*arguments)


def _placement(placement: pin.SE3) -> Array:
    return np.concatenate([placement.rotation.ravel(), placement.translation])


def _se3(numbers: Array) -> pin.SE3:
    rotation = numbers[:9].reshape(3, 3)
    _require(bool(np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-6), "a rotation is not orthogonal")
    return pin.SE3(rotation, numbers[9:])


def _inertia(inertia: pin.Inertia) -> Array:
    return np.concatenate([[inertia.mass], inertia.lever, inertia.inertia[np.tril_indices(3)]])


def _inertia_of(numbers: Array) -> pin.Inertia:
    about_centre = np.zeros((3, 3))
    about_centre[np.tril_indices(3)] = numbers[4:]
    about_centre += np.tril(about_centre, -1).T
    _require(bool(numbers[0] >= 0.0), "a mass is negative")
    return pin.Inertia(float(numbers[0]), numbers[1:4], about_centre)


def _require(holds: bool, otherwise: str) -> None:
    if not holds:
        raise ValueError(otherwise)


def _of_kind(value: object, kind: type[T], what: str) -> T:
    if not isinstance(value, kind):
        raise ValueError(f"{what} is a {type(value).__name__}, not a {kind.__name__}")
    return value


def _entries(data: Mapping[str, object], name: str, most: int) -> list[Json]:
    found: list[Json] = _of_kind(data.get(name), list, name)
    _require(len(found) <= most, f"{name} has {len(found)} entries, more than {most}")
    return found


def _array(data: Mapping[str, object], name: str, shape: tuple[int, ...], infinite: bool = False) -> Array:
    """Read an array of a shape; NaN is refused, infinity too where it means nothing."""
    found = _of_kind(data.get(name), np.ndarray, name)
    _require(found.dtype == np.float64 and found.shape == shape, f"{name} has the shape {found.shape}, not {shape}")
    bad = np.isnan(found) if infinite else ~np.isfinite(found)
    _require(not bad.any(), f"{name} holds a number that is not finite")
    return found
