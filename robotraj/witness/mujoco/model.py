"""The MuJoCo model of a robot, built from its Pinocchio model: bodies, joints, inertias, friction and limits.

The URDF is not read again. The Pinocchio model contains locked joints, mirrored frames, design parameters and rotor
inertias, and the contact simulation needs no meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.robot.coupling.mimics import Mimic, mimics_of
from robotraj.robot.limits import Limits
from robotraj.robot.loading.planning_model import independent_joint
from robotraj.witness.mujoco.coordinates import Coordinates
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.protocols import RobotLike

if TYPE_CHECKING:
    import mujoco


COUPLING, RIGID = (0.005, 1.0), (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""Time constant [s] with damping ratio, and impedance, of the equation of a follower: the stiffest that MuJoCo has."""


@dataclass(frozen=True)
class MujocoRobot:
    """A robot in MuJoCo.

    Attributes
    ----------
    model : mujoco.MjModel
    coordinates : Coordinates
        Conversion between Pinocchio's q, v, a, tau and MuJoCo's.
    """

    model: mujoco.MjModel
    coordinates: Coordinates


def mujoco_robot(
    robot: RobotLike,
    limits: Limits | None = None,
    furnish: Callable[[mujoco.MjSpec, dict[int, mujoco.MjsBody]], None] | None = None,
) -> MujocoRobot:
    """Build a robot's MuJoCo model from its Pinocchio model.

    Without contacts and limits its accelerations are those of Pinocchio's ABA. Viscous damping becomes MuJoCo's
    ``damping``, Coulomb friction its ``frictionloss``: dry friction, which plans smooth by tanh.

    Parameters
    ----------
    robot : Robot
    limits : Limits, optional
        Position limits become MuJoCo's soft joint limits; none by default.
    furnish : callable, optional
        ``furnish(spec, bodies)`` adds feet and ground before the model is compiled; ``bodies`` are MuJoCo's body
        specifications by Pinocchio's joint.

    Raises
    ------
    InputError
        MuJoCo is not installed, or a joint is neither a hinge nor a slide nor a free-flyer.
    """
    mujoco = load_mujoco()
    model = robot.model
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = model.gravity.linear
    bodies = {0: spec.worldbody}
    for joint in range(1, model.njoints):
        bodies[joint] = _body(mujoco, model, joint, bodies[model.parents[joint]])
    for mimic in mimics_of(model):
        _couple(mujoco, spec, mimic)
    if limits is not None:
        _limit(mujoco, spec, limits)
    if furnish is not None:
        furnish(spec, bodies)
    compiled = spec.compile()
    coordinates = Coordinates(model, compiled)

    # MuJoCo's compiler refuses massless bodies and the inertias of point masses and planar models, but its dynamics
    # accept them. The bodies are compiled with placeholders, which are replaced here.
    for joint in range(1, model.njoints):
        body = compiled.body(model.names[joint]).id
        compiled.body_mass[body] = model.inertias[joint].mass
        compiled.body_inertia[body] = _principal(model.inertias[joint])[0]
    for name, stiffness, rest in robot.springs:
        joint = compiled.joint(name)
        joint.stiffness[...] = stiffness
        compiled.qpos_spring[joint.qposadr[0]] = rest
    losses = np.array([np.broadcast_to(value, robot.nv) for value in (robot.damping, robot.friction)], dtype=float)
    compiled.dof_armature[coordinates.dofs] = model.armature
    compiled.dof_damping[coordinates.dofs] = losses[0]
    compiled.dof_frictionloss[coordinates.dofs] = losses[1]
    mujoco.mj_setConst(compiled, mujoco.MjData(compiled))
    return MujocoRobot(compiled, coordinates)


def _body(mujoco: ModuleType, model: pin.Model, joint: int, parent: mujoco.MjsBody) -> mujoco.MjsBody:
    """Add the body of a joint."""
    name, placement, inertia = model.names[joint], model.jointPlacements[joint], model.inertias[joint]
    body = parent.add_body(name=name, pos=placement.translation, quat=wxyz(placement.rotation))
    body.explicitinertial = True
    body.mass, body.inertia = 1.0, np.ones(3)
    body.ipos, body.iquat = np.array(inertia.lever), wxyz(_principal(inertia)[1])
    kind = model.joints[joint].shortname()
    if kind == "JointModelFreeFlyer" and model.parents[joint] == 0 and placement.isIdentity():
        body.add_freejoint(name=name, align=mujoco.mjtAlignFree.mjALIGNFREE_FALSE)
        return body
    angular, linear = _axes(model, joint)
    if angular.any() == linear.any():
        raise InputError(
            f"Joint {name!r} is a {kind.removeprefix('JointModel')}; second_opinion() accepts hinges, slides and a "
            "free-flyer at the root. Use rt.validate."
        )
    hinge = angular.any()
    kind = mujoco.mjtJoint.mjJNT_HINGE if hinge else mujoco.mjtJoint.mjJNT_SLIDE
    body.add_joint(name=name, type=kind, axis=angular if hinge else linear)
    return body


def _couple(mujoco: ModuleType, spec: mujoco.MjSpec, mimic: Mimic) -> None:
    """Add MuJoCo's equation follower = offset + multiplier * leader, a constraint as stiff as the solver permits."""
    equation = spec.add_equality(name1=mimic.follower, name2=mimic.leader, solref=COUPLING, solimp=RIGID)
    equation.type, equation.objtype = mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtObj.mjOBJ_JOINT
    equation.data[:5] = [mimic.offset, mimic.multiplier, 0.0, 0.0, 0.0]


def _axes(model: pin.Model, joint: int) -> tuple[Array, Array]:
    """Return the angular and linear axis (3,) of a joint of one degree of freedom, zeros for others."""
    moving = model.joints[joint]
    if moving.nv > 1:
        return np.zeros(3), np.zeros(3)
    if moving.nv == 0:
        moving = independent_joint(model, joint)
        moving.setIndexes(1, 0, 0)
    data = moving.createData()
    moving.calc(data, np.zeros(model.nq))
    subspace = np.asarray(data.S, dtype=float).ravel()
    return subspace[3:], subspace[:3]


def _principal(inertia: pin.Inertia) -> tuple[Array, Array]:
    """Return principal moments (3,) [kg m^2] about the centre of mass and the rotation (3, 3) to their axes."""
    moments, axes = np.linalg.eigh(inertia.inertia)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return moments, axes


def _limit(mujoco: ModuleType, spec: mujoco.MjSpec, limits: Limits) -> None:
    """Set the position limits of joints with two finite ones."""
    for i, name in enumerate(limits.joints):
        low, high = float(limits.position_lower[i]), float(limits.position_upper[i])
        joint = spec.joint(name)
        if joint is not None and joint.type != mujoco.mjtJoint.mjJNT_FREE and np.isfinite([low, high]).all():
            joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, [low, high]


def wxyz(rotation: Array) -> Array:
    """Return the quaternion (w, x, y, z) of a rotation (3, 3)."""
    x, y, z, w = pin.Quaternion(np.ascontiguousarray(rotation)).coeffs()
    return np.array([w, x, y, z])
