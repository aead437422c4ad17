"""The mirror image of a robot about its x-z plane, found by names and checked by geometry and inertia."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.gait.mirroring.imbalance import IMBALANCE
from robotraj.gait.mirroring.imbalance import imbalance as imbalance_of
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.links.periodic import Mirror
from robotraj.robot.coupling.dynamics import joint_axes
from robotraj.robot.robot import Robot
from robotraj.robot.sides.images import REFLECTION, frames_across

AXIAL = -REFLECTION
"""Factors of rotation axes, which are mirrored like angular velocities."""
ROOT = {
    "fixed": (),
    "planar": (),
    "floating": ("root_y", "root_qx", "root_qz", "root_vy", "root_wx", "root_wz"),
}
"""Names of the root's entries of q and v that change sign."""
SAMPLES = 8
"""Number of seeded random configurations in which positions are compared."""


def mirror(
    robot: Robot,
    displacement: Mapping[str, float | Between | None] | None = None,
    partners: Mapping[str, str] | None = None,
    tolerance: float = 1e-3,
    imbalance: float = IMBALANCE,
) -> Mirror:
    """Return the ``rt.Mirror`` that swaps left and right, for a robot that is its own image about the plane y = 0.

    Joints and frames are paired by their names (``left_``/``right_``, ``FL``/``FR``, ``l_``/``r_`` ...), else by their
    places. Those without another side are their own partners. The axes with all joints at zero determine the signs. A
    rotation axis (a_x, a_y, a_z) has the image (-a_x, a_y, -a_z), and one of translation (a_x, -a_y, a_z). The sign of
    a joint is negative if the partner's axis is opposite to the image. A floating root keeps x, z and pitch and negates
    y, roll and yaw: the states q.root_y, q.root_qx, q.root_qz, v.root_vy, v.root_wx and v.root_wz.

    Geometry and inertia are then compared in seeded random configurations. In the mirrored configuration the partner of
    every joint must be at (x, -y, z). The moment of gravity about the root must be the mirrored one. Pairs of frames
    that are not images, such as cameras, are dropped. A planar robot moves in the plane of the mirror.

    Parameters
    ----------
    robot : Robot
    displacement : mapping, optional
        Displacement in a period, ``{"q.root_x": 0.3}``; see ``rt.Mirror``.
    partners : mapping of str to str, optional
        Pairs of joints and frames that the names do not show.
    tolerance : float
        Largest distance [m] of a partner from the image; symmetric robots have a fraction of a millimetre.
    imbalance : float
        Largest violation of the equations of motion by a mirrored half of a gait. It is the difference of accelerations
        relative to g over the robot's size.

    Raises
    ------
    InputError
        The robot is not its own mirror image. The message names the joint or frame with its distance from the image,
        or the difference of the accelerations.
    """
    found = mirror_by_geometry(robot, displacement, partners, tolerance)
    off = imbalance_of(robot, found)
    if off > imbalance:
        raise InputError(
            f"The inertia of {robot.name!r} is not symmetric: under mirrored torques an acceleration differs by "
            f"{off:.2g} of g over the robot's size, beyond {imbalance:.2g}. Plan both halves with "
            "repeat=rt.Periodic(), or raise imbalance=."
        )
    return found


def mirror_by_geometry(
    robot: Robot,
    displacement: Mapping[str, float | Between | None] | None = None,
    partners: Mapping[str, str] | None = None,
    tolerance: float = 1e-3,
) -> Mirror:
    """Return the mirror of a robot without comparing its inertia; parameters and errors are those of ``mirror``."""
    given = dict(partners or {})
    given |= {b: a for a, b in given.items()}
    joints, frames = robot.joint_names, robot.frame_names
    for name in given:
        if name not in joints and name not in frames:
            raise InputError(
                f"mirror(partners=...): {robot.name!r} has no joint or frame named {name!r}; correct the name."
            )
    partner = frames_across(robot, joints, pin.neutral(robot.model)) | {k: v for k, v in given.items() if k in joints}
    signs = _signs(robot, partner)
    sides = frames_across(robot, frames, pin.neutral(robot.model)) | {k: v for k, v in given.items() if k in frames}
    off = _gaps(robot, partner, signs, sides)
    for item, gap in off.items():
        if gap > tolerance and (item in partner or item in given):
            raise InputError(
                f"{'Joint' if item in partner else 'Frame'} {item!r} of {robot.name!r} is {gap:.2g} m from its "
                "mirror image: left and right of the robot differ. Name partners= where the names mislead, raise "
                "tolerance=, or plan both halves with rt.Periodic."
            )
    sides = {name: other for name, other in sides.items() if off.get(name, 0.0) <= tolerance}
    own = set(ROOT[robot.root]) | {name for name, sign in signs.items() if sign < 0}
    pairs = {a: b for a, b in (sides | partner).items() if a != b}
    once = {a: b for a, b in pairs.items() if a <= b or pairs.get(b) != a}
    labels = (*robot.position_names, *robot.velocity_names)
    return Mirror(once, tuple(n for n in dict.fromkeys(labels) if n in own), dict(displacement or {}))


def _signs(robot: Robot, partner: Mapping[str, str]) -> dict[str, float]:
    """Return the sign of every joint but the root, from the axes where all joints are zero."""
    model, data, joints = robot.model, robot.model.createData(), set(robot.joint_names)
    axes = joint_axes(model, data, pin.neutral(model))
    signs = {}
    for index in range(1, model.njoints):
        name = model.names[index]
        if name not in joints or (name.startswith("root_") and robot.root != "fixed"):
            continue  # its followers move with their leader
        axis, other = (axes[:, model.joints[model.getJointId(n)].idx_v] for n in (name, partner[name]))
        turns = np.linalg.norm(axis[3:]) > 0.5
        part, rule = (slice(3, 6), AXIAL) if turns else (slice(0, 3), REFLECTION)
        along = float(other[part] @ (rule * axis[part]))
        if abs(abs(along) - 1.0) > 1e-3:
            raise InputError(
                f"Joint {name!r} of {robot.name!r} has no mirror image in {partner[name]!r}: with all joints at zero "
                f"its axis {np.round(axis[part], 4).tolist()} has the image {np.round(rule * axis[part], 4).tolist()}, "
                f"but the other has {np.round(other[part], 4).tolist()}. Name the right one with partners=."
            )
        signs[name] = float(np.sign(along))
    return signs


def _gaps(
    robot: Robot, partner: Mapping[str, str], signs: Mapping[str, float], sides: Mapping[str, str]
) -> dict[str, float]:
    """Return the largest distances [m] of joints and frames from their images in random configurations."""
    model, names = robot.model, robot.position_names
    rng = np.random.default_rng(0)
    at = {name: i for i, name in enumerate(names)}
    joints = [(model.getJointId(name), model.getJointId(partner[name]), name) for name in robot.joint_names]
    frames = [(robot.frame(a), robot.frame(b), a) for a, b in sides.items() if a != b and a not in partner]
    worst = {name: 0.0 for _, _, name in (*joints, *frames)}
    for _ in range(SAMPLES):
        q = np.array(pin.neutral(model))
        for name in signs:
            q[at[name]] = rng.uniform(-1.0, 1.0)
        image = np.array(q)
        for name, sign in signs.items():
            image[at[name]] = sign * q[at[partner[name]]]
        here, there = model.createData(), model.createData()
        pin.framesForwardKinematics(model, here, q)
        pin.framesForwardKinematics(model, there, image)
        axes = joint_axes(model, there, image)
        for pairs, places in ((joints, "oMi"), (frames, "oMf")):
            first, second = getattr(here, places), getattr(there, places)
            for a, b, name in pairs:
                gap = second[b].translation - REFLECTION * first[a].translation
                if places == "oMi" and model.joints[b].nv == 1:
                    # Axes of rotation are lines: where a joint lies along its axis has no effect.
                    axis = axes[3:, model.joints[b].idx_v]
                    gap = gap - (axis @ gap) * axis
                worst[name] = max(worst[name], float(np.linalg.norm(gap)))
    return worst
