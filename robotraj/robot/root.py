"""The root of a robot: fixed, moving in the plane y = 0, or floating.

Planar: three plain joints before the URDF's root link, along world x, along world z, then about +y. Floating:
Pinocchio's free-flyer. Its position is that of the root link's origin in the world and the quaternion (x, y, z, w). Its
velocity is that of the root link in the link's axes, linear part first. Neither root has motors, limits or damping.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.values import dataclass
from robotraj.robot.loading.planning_model import has_free_flyer, rebuilt


@dataclass(frozen=True)
class Root:
    """The connection of a robot to the world: fixed, planar or floating.

    Attributes
    ----------
    joints : tuple of str
        Names of its joints in Pinocchio's model.
    positions, velocities : tuple of str
        Names of its entries of q and of v.
    position_units : tuple of str
        Units of the positions; a quaternion has none.
    units : tuple of str
        ``"m"`` or ``"rad"``: units of the velocities times seconds.
    """

    joints: tuple[str, ...] = ()
    positions: tuple[str, ...] = ()
    velocities: tuple[str, ...] = ()
    position_units: tuple[str, ...] = ()
    units: tuple[str, ...] = ()


PLANAR = ("root_x", "root_z", "root_pitch")

ROOTS = {
    "fixed": Root(),
    "floating": Root(
        ("root_joint",),
        ("root_x", "root_y", "root_z", "root_qx", "root_qy", "root_qz", "root_qw"),
        ("root_vx", "root_vy", "root_vz", "root_wx", "root_wy", "root_wz"),
        ("m", "m", "m", "", "", "", ""),
        ("m", "m", "m", "rad", "rad", "rad"),
    ),
    "planar": Root(PLANAR, PLANAR, PLANAR, ("m", "m", "rad"), ("m", "m", "rad")),
}

QUATERNION = slice(3, 7)
"""Entries of the quaternion in q of a floating root."""


def root_of(name: str) -> Root:
    """Return the root of a name.

    Raises
    ------
    UnknownName
        There is no such root.
    """
    if not isinstance(name, str) or name not in ROOTS:
        raise unknown_name(
            "root", name, ROOTS, "'planar' is the vertical plane y = 0; rt.robot.on_wheels drives on level ground."
        )
    return ROOTS[name]


def units_of(model: pin.Model, root: str = "fixed") -> tuple[str, ...]:
    """Return the unit of each joint's position: ``"m"`` for a prismatic joint, else ``"rad"``."""
    about = root_of(root)
    result = list(about.units)
    for joint in model.joints.tolist()[1 + len(about.joints) :]:
        if not joint.nv:
            continue  # it follows another joint
        data = joint.createData()
        joint.calc(data, np.zeros(joint.nq))
        result.append("rad" if np.any(np.asarray(data.S).reshape(6)[3:]) else "m")
    return tuple(result)


def with_root(model: pin.Model, root: str) -> pin.Model:
    """Return a copy in which the joints of the root move the root link and the bodies fixed to it.

    Reference configurations of the model are kept, with the root at the origin. A model that starts with a free-flyer
    keeps it under the name ``root_joint``. The model's position limits of the root are 1 m and half a turn in both
    directions, so that ``pin.randomConfiguration`` is finite; ``Limits`` contains none.

    Raises
    ------
    InputError
        The model starts with a free-flyer and ``root`` is another, or joints or frames have reserved names.
    """
    about = root_of(root)
    if has_free_flyer(model):
        return _near(_named(model, root), about)
    copy = model.copy()
    if root == "fixed":
        return copy
    for frame in copy.frames:
        if frame.type == pin.FrameType.FIXED_JOINT and frame.name in (
            *about.joints,
            *about.positions,
            *about.velocities,
        ):
            frame.name += "_fixed"
    _check_names(copy, about, root)
    copy = rebuilt(copy, tuple(zip(about.joints, _joints(root), strict=True)))
    for entry in model.referenceConfigurations:
        start = pin.neutral(copy)[: len(about.positions)]
        copy.referenceConfigurations[entry.key()] = np.concatenate([start, entry.data()])
    return _near(copy, about)


def in_plane(q: Array) -> Array:
    """Return root_x, root_z and root_pitch of a floating root's seven positions [m, m, rad].

    The pitch is that of the rotation about y nearest to the quaternion's.
    """
    rotation = pin.Quaternion(q[QUATERNION]).matrix()
    pitch = np.arctan2(rotation[0, 2] - rotation[2, 0], rotation[0, 0] + rotation[2, 2])
    return np.array([q[0], q[2], pitch])


def carried(shapes: pin.GeometryModel, before: int) -> pin.GeometryModel:
    """Return a copy of shapes for a model with ``before`` more joints before its root link."""
    copy = shapes.copy()
    for shape in copy.geometryObjects:
        shape.parentJoint += before
        shape.parentFrame += before
    return copy


def _near(model: pin.Model, about: Root) -> pin.Model:
    """Bound the positions of the root, in place; Pinocchio samples random configurations within these bounds."""
    reach = np.array([np.pi if unit == "rad" else 1.0 for unit in about.position_units])
    model.lowerPositionLimit[: len(reach)] = -reach
    model.upperPositionLimit[: len(reach)] = reach
    return model


def _joints(root: str) -> Sequence[pin.JointModel]:
    if root == "floating":
        return (pin.JointModelFreeFlyer(),)
    return (pin.JointModelPX(), pin.JointModelPZ(), pin.JointModelRY())


def _named(model: pin.Model, root: str) -> pin.Model:
    """Return a copy of a model with a free-flyer, whose joint and frame get the names of the root."""
    own = model.names[1]
    if root != "floating":
        raise InputError(
            f"The model starts with the free joint {own!r}, but root={root!r}. Load it with root='floating', the "
            "default of such a model, or take the free joint out of the file."
        )
    about = ROOTS[root]
    _check_names(model, about, root, own)
    copy = model.copy()
    copy.names[1] = about.joints[0]
    for frame in copy.frames:
        if frame.name == own and frame.type == pin.FrameType.JOINT:
            frame.name = about.joints[0]
    return copy


def _check_names(model: pin.Model, about: Root, root: str, own: str | None = None) -> None:
    """Check that no joint or frame of the model has a name of the root."""
    known = {*model.names, *(frame.name for frame in model.frames)} - {own}
    taken = [name for name in dict.fromkeys((*about.joints, *about.positions, *about.velocities)) if name in known]
    if taken:
        raise InputError(
            f"root={root!r} adds {', '.join(map(repr, taken))}, but joints or links of {model.name!r} have the same "
            "name. Rename them in the URDF; or, if they are its own moving root, load it with root='fixed'."
        )
