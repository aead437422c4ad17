"""Random trees of joints of which some follow others."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj.robot.coupling.mimics import Mimic

KINDS = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ, pin.JointModelPX, pin.JointModelPZ)


def random_tree(seed: int, joints: int = 7, floating: bool = False) -> tuple[pin.Model, tuple[Mimic, ...]]:
    """Return a model of independent joints, and couplings of about half of them to leaders anywhere in the tree."""
    rng = np.random.default_rng(seed)
    model = pin.Model()
    model.name = "tree"
    if floating:
        root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        model.addJointFrame(root)
        model.appendBodyToJoint(root, _body(rng), _pose(rng))
    path = [1 if floating else 0]
    for k in range(joints):
        # Pinocchio needs joints in depth-first order: a new one stands on the last joint or on one that carries it.
        path = path[: int(rng.integers(1, len(path) + 1))]
        parent = path[-1]
        if rng.random() < 0.3:
            axis = rng.normal(size=3)
            kind = pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis))
        else:
            kind = KINDS[int(rng.integers(len(KINDS)))]()
        joint = model.addJoint(parent, kind, _pose(rng), f"j{k}", *(np.full(1, x) for x in (50.0, 3.0, -2.0, 2.0)))
        path.append(joint)
        model.addJointFrame(joint)
        model.appendBodyToJoint(joint, _body(rng), _pose(rng))
        model.addFrame(pin.Frame(f"tip{k}", joint, model.nframes - 1, _pose(rng), pin.FrameType.OP_FRAME))
    first = 6 if floating else 0
    model.armature = np.append(np.zeros(first), rng.uniform(0.0, 0.1, joints))
    model.damping = np.append(np.zeros(first), rng.uniform(0.0, 0.3, joints))
    followers = rng.permutation(joints)[: joints // 2].tolist()
    leaders = [k for k in range(joints) if k not in followers]
    mimics = []
    for k in followers:
        free = [i for i in leaders if i < k]
        if free:
            leader = free[int(rng.integers(len(free)))]
            mimics.append(Mimic(f"j{k}", f"j{leader}", float(rng.choice([-1, 1]) * rng.uniform(0.3, 2)), rng.normal()))
    return model, tuple(mimics)


def _pose(rng: np.random.Generator) -> pin.SE3:
    quaternion = rng.normal(size=4)
    return pin.SE3(pin.Quaternion(quaternion / np.linalg.norm(quaternion)).matrix(), rng.uniform(-0.4, 0.4, 3))


def _body(rng: np.random.Generator) -> pin.Inertia:
    axes = _pose(rng).rotation
    return pin.Inertia(rng.uniform(0.2, 3.0), rng.uniform(-0.2, 0.2, 3), axes @ np.diag([0.04, 0.05, 0.06]) @ axes.T)
