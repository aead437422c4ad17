"""``load``: make a robot from a name, a file or a model."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence

import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.errors import InputError
from robotraj.robot.joint_limits.values import PositionLimits, RateLimits
from robotraj.robot.limits import Limits
from robotraj.robot.loading.assembly import assemble
from robotraj.robot.loading.planning_model import has_free_flyer
from robotraj.robot.loading.source import describe
from robotraj.robot.mounting import Base, mounted, placed
from robotraj.robot.robot import Robot
from robotraj.robot.springs.sprung import sprung


def load(
    source: str | os.PathLike[str] | pin.Model | pin.RobotWrapper,
    *,
    package_dirs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    trust_paths: bool = False,
    actuated: Iterable[str] | None = None,
    locked: Mapping[str, float | Sequence[float]] | None = None,
    root: str | None = None,
    limits: Limits | Mapping[str, PositionLimits | RateLimits] | None = None,
    gravity: ArrayLike | None = None,
    base: Base | None = None,
    rotors: Mapping[str, tuple[float, float]] | None = None,
    springs: Mapping[str, float | tuple[float, float]] | None = None,
) -> Robot:
    """Load a robot for planning.

    Parameters
    ----------
    source : str, path, pinocchio.Model or pinocchio.RobotWrapper
        A name, the path of a URDF, xacro or MJCF file, or a model, which is copied and not changed. ``catalogue()``
        lists the names; robotraj's robots precede those of example-robot-data. Macros of xacro need the package
        ``xacro``.
    package_dirs : path or sequence of paths
        Folders that are searched for meshes first: those above a package, or packages themselves.
    trust_paths : bool
        Read meshes from any path that the file names, and search the folders above the URDF and ROS's package paths.
        Default: meshes in ``package_dirs`` and in the URDF's package only. That is the folder with ``package.xml``, or
        the one above ``urdf/``, ``robots/`` or ``models/``; else the URDF's own. Robots of the catalogue are trusted.
    actuated : iterable of str, optional
        Joints with a motor. Default: those of the catalogue (acrobot: the elbow; cartpole: the slider), else all.
    locked : mapping, optional
        Joints locked at a position, ``{"wrist": 0.0}`` [rad, m]; q and v do not contain them. A joint of several
        degrees of freedom has one number for each, ``{"drive": (x, y, yaw)}``, or 0 for all.
    root : str, optional
        ``"fixed"``, the default: the URDF's root link does not move. ``"planar"``: it moves in the vertical plane y = 0
        and turns about y. ``"floating"``: it moves freely, with a quaternion; the default and the only choice for a
        model whose first joint is free, as in MJCF files of legged robots. A moving root has no motors, limits or
        damping; see ``Robot``. A base that drives on level ground is
        a planar joint of the URDF, or ``rt.robot.on_wheels(robot, mass, inertia)``.
    limits : mapping or Limits, optional
        Overrides by quantity: ``{"position": {"elbow": (-1, 1)}, "velocity": 3.0, "effort": {"elbow":
        20}}``; see ``Limits.with_``.
    gravity : array (3,), optional
        [m/s^2] in the world; (0, 0, -9.81) by default.
    base : pinocchio.SE3 or (position, quaternion), optional
        Pose of the URDF's root link in the world [m], quaternion (x, y, z, w). With a moving root it is the pose in the
        axes of that root, such as a quarter turn about x for files whose y axis is up.
    rotors : mapping of str to (float, float), optional
        Inertia of the rotor [kg m^2] and gear ratio by joint, ``{"elbow": (1e-5, 100)}``.
    springs : mapping, optional
        Springs at joints: stiffness [N m/rad, N/m], or stiffness and position without torque [rad, m],
        ``{"knee": (20.0, -0.5)}``. By default those of the MJCF file, or of the URDF's elements for Gazebo.

    Returns
    -------
    Robot
        Frozen. ``print(robot)`` lists its joints, limits and the notes of loading.

    Raises
    ------
    InputError
        The name is unknown, the file unreadable, or the robot loaded already. The URDF is not a tree, is too large,
        or has numbers that are missing, NaN or infinite. A moving body has an indefinite inertia, or a joint several
        degrees of freedom. A joint or link has a reserved name of the root. No joint moves. The limits are impossible.

    Warns
    -----
    UserWarning
        The URDF has inertias that no rigid body can have, joints without moving mass, implausible limits or
        lengths, or meshes that do not exist. ``robot.notes`` and ``robotraj show`` list them.

    Notes
    -----
    Joints that follow others by ``<mimic>`` have no entries in q and v: with q_all = S q + s the equations of motion
    are S' M S a + S' h = tau. A leader's limits lie within those of its followers, and its motor drives them all;
    ``locked={leader: value}`` holds them still. Robots of the catalogue are loaded with such joints locked. Rotor
    inertias are added to the armature. The neutral configuration is the SRDF's reference, else zero, moved inside the
    position limits.
    """
    if isinstance(source, Robot):
        raise InputError(
            f"rt.load got {source.name!r}, a robot that is loaded. Load its file or name with all options."
        )
    about = describe(source, package_dirs, trust_paths)
    if root is None:
        root = "floating" if has_free_flyer(about.model) else "fixed"
    robot = assemble(about if base is None else placed(about, base), actuated, locked, limits, root)
    if gravity is not None or rotors is not None:
        robot = mounted(robot, gravity, rotors)
    moving = {*robot.velocity_names, *(mimic.follower for mimic in robot.followers)}
    own = {joint: spring for joint, spring in about.springs.items() if joint in moving}
    return robot if springs is None and not own else sprung(robot, own if springs is None else springs)
