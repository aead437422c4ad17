"""A Pinocchio model as the tree of joints on which the compiled module evaluates inverse dynamics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native._native import RigidTree

_TINY = 1e-14
_NO_AXIS = np.zeros(3)


def rigid_tree(model: pin.Model) -> RigidTree:
    """Copy the numbers of a model.

    Raises
    ------
    ValueError
        A joint neither turns about an axis nor slides along one, and is no free-flyer at the root.
    """
    flies = model.njoints > 1 and model.joints[1].shortname() == "JointModelFreeFlyer"
    neutral = pin.neutral(model)
    parents, turns, numbers, armature = [], [], [], []
    for i in range(1, model.njoints):
        joint, free = model.joints[i], flies and i == 1
        if flies and not free and model.parents[i] == 0:
            raise ValueError(f"joint '{model.names[i]}' is attached to the world beside a free-flyer")
        direction, angular = (_NO_AXIS, False) if free else _axis(model.names[i], joint, neutral)
        place, body = model.jointPlacements[i], model.inertias[i]
        parents.append(model.parents[i] - 1)
        turns.append(int(angular))
        parts = (direction, place.rotation.ravel(), place.translation, [body.mass], body.lever, body.inertia.ravel())
        numbers.append(np.concatenate(parts))
        armature.append(0.0 if free else model.armature[joint.idx_v])
    if flies and np.any(model.armature[:6]):
        raise ValueError("the free-flyer has armature")
    tree: RigidTree = load_native().RigidTree(
        np.array(parents, dtype=np.int64),
        np.array(turns, dtype=np.int64),
        np.concatenate(numbers) if numbers else np.zeros(0),
        np.array(armature),
        np.array(model.gravity.linear),
        flies,
    )
    return tree


def _axis(name: str, joint: pin.JointModel, neutral: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], bool]:
    """Return the direction of a joint's axis, and whether it turns about it."""
    if joint.nq == 1 and joint.nv == 1:
        data = joint.createData()
        joint.calc(data, neutral)
        motion = np.array(data.S).reshape(6)
        linear, angular = motion[:3], motion[3:]
        for direction, other in ((angular, linear), (linear, angular)):
            if math.hypot(*other) < _TINY and abs(math.hypot(*direction) - 1.0) < _TINY:
                return direction, direction is angular
    raise ValueError(f"joint '{name}' ({joint.shortname()}) neither turns about an axis nor slides along one")
