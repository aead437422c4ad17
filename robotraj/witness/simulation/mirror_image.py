"""The mirror image of a robot, which simulates the mirrored half of a gait with the planned half.

Half a gait is planned and the other half mirrored. ``rt.gait.mirror`` checks geometry, but inertia is seldom symmetric.
The plan is kept, and every body of the robot is replaced by the mirror image of its partner. This mirrors the world
instead of the motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.problem.links.periodic import Mirror
from robotraj.problem.links.touchdown import Touchdown
from robotraj.robot.robot import Robot
from robotraj.witness.protocols import SolutionLike

REFLECTION = np.diag([1.0, -1.0, 1.0])
"""Reflection in the x-z plane of the world."""

MIRRORED = " (mirrored)"
"""Suffix of the name of a phase whose mirrored half is simulated."""

SAME = 1e-9
"""Largest relative difference of equal inertias."""


def mirror_of(solution: SolutionLike) -> Mirror | None:
    """Return the link that closes the plan on its mirror image, None without one."""
    for link in solution.problem.links:
        repeat = link.repeat if isinstance(link, Touchdown) else link
        if isinstance(repeat, Mirror):
            return repeat
    return None


def mirror_image(robot: Robot, mirror: Mirror) -> Robot | None:
    """Return the robot with the mirrored inertias of its partners' bodies, None where they are equal.

    At q = 0, which is its own image, a body with mass m, centre c and inertia I about it, in world axes, has the image
    m, R c, R I R with R = diag(1, -1, 1). Armature, damping, friction and springs come from the partner.
    """
    model, both = robot.model, {**mirror.partners, **{b: a for a, b in mirror.partners.items()}}
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    image = pin.Model(model)
    changed = False
    for i in range(1, model.njoints):
        partner = _partner(model, i, both)
        body = data.oMi[partner].act(model.inertias[partner])
        reflected = pin.Inertia(body.mass, REFLECTION @ body.lever, REFLECTION @ body.inertia @ REFLECTION)
        found = data.oMi[i].actInv(reflected)
        size = np.abs(found.matrix()).max(initial=0.0)
        changed |= bool(np.abs(found.matrix() - model.inertias[i].matrix()).max() > SAME * size)
        image.inertias[i] = found
    order = _velocity_order(model, both)
    for name in ("armature", "rotorInertia", "rotorGearRatio"):
        setattr(image, name, np.array(getattr(model, name))[order])
    damping, friction = np.asarray(robot.damping)[order], np.asarray(robot.friction)[order]
    signs = {joint: -1.0 if joint in mirror.negated else 1.0 for joint in robot.velocity_names}
    springs = {both.get(joint, joint): (k, signs[joint] * rest) for joint, k, rest in robot.springs}
    sprung = tuple((joint, *springs[joint]) for joint in robot.velocity_names if joint in springs)
    same = all(np.array_equal(a, b) for a, b in ((damping, robot.damping), (friction, robot.friction)))
    same = same and sprung == robot.springs
    if not changed and same and np.array_equal(image.armature, model.armature):
        return None
    return replace(robot, model=image, damping=damping, friction=friction, springs=sprung)


def _partner(model: pin.Model, joint: int, both: Mapping[str, str]) -> int:
    name = model.names[joint]
    return int(model.getJointId(both.get(name, name)))


def _velocity_order(model: pin.Model, both: Mapping[str, str]) -> Array:
    """Return for every velocity the index of its partner."""
    order = np.arange(model.nv)
    for i in range(1, model.njoints):
        own, other = model.joints[i], model.joints[_partner(model, i, both)]
        order[own.idx_v : own.idx_v + own.nv] = np.arange(other.idx_v, other.idx_v + other.nv)
    return order
