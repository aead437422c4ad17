"""The inertia of a robot compared with that of its mirror image."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.problem.links.periodic import Mirror
from robotraj.robot.coupling.dynamics import mass_matrix
from robotraj.robot.robot import Robot

IMBALANCE = 1e-3
"""Largest difference of accelerations, relative to g over the robot's size, of a robot that counts as symmetric."""
SAMPLES = 8
"""Number of seeded random configurations that are compared."""
SLOW = 0.3
"""Speeds and accelerations of a gait relative to sqrt(g / h) and g / h, h the height of the centre of mass."""


def imbalance(robot: Robot, repeat: Mirror) -> float:
    """Return the relative error of accelerations that mirrored torques cause in the mirror image of a motion.

    For seeded random motions (q, v, a) and their images, marked ', the torques r' of inverse dynamics and springs are
    compared with the image P r. The error is the largest entry of |M(q')^-1 (r' - P r)| relative to g / h [rad/s^2],
    and relative to g for the root's translation. The size h is the height of the centre of mass above the lowest joint
    in the neutral configuration. v and a are random, up to ``SLOW`` times sqrt(g / h) and g / h. The result is 0 for a
    robot with a fixed or planar root.
    """
    if robot.root != "floating":
        return 0.0
    model, data = robot.model, robot.model.createData()

    def torques(q: Array, v: Array, a: Array) -> Array:
        return np.asarray(pin.rnea(model, data, q, v, a) + robot.resistance(q, np.zeros(robot.nv)))

    partners = repeat.partner_of
    negated = set(repeat.negated)
    com = np.array(pin.centerOfMass(model, data, robot.neutral))
    pin.forwardKinematics(model, data, robot.neutral)
    size = max(float(com[2]) - min(float(place.translation[2]) for place in list(data.oMi)[1:]), 1e-3)
    gravity = float(np.linalg.norm(model.gravity.linear))
    # The unit of length is h, and that of time sqrt(h / g).
    lengths = np.where(np.equal(robot.units, "m"), size, 1.0)
    speeds, accelerations = SLOW * lengths * np.sqrt(gravity / size), SLOW * lengths * gravity / size
    rng, worst = np.random.default_rng(0), 0.0
    for _ in range(SAMPLES):
        q = np.array(robot.neutral)
        q[7:] += rng.uniform(-0.5, 0.5, len(q) - 7)
        v, a = speeds * rng.uniform(-1.0, 1.0, robot.nv), accelerations * rng.uniform(-1.0, 1.0, robot.nv)
        image = _image(q, robot.position_names, partners, negated)
        r, moved, pushed = (_image(each, robot.velocity_names, partners, negated) for each in (torques(q, v, a), v, a))
        gap = torques(image, moved, pushed) - r
        change = np.linalg.solve(mass_matrix(model, data, image), gap)
        worst = max(worst, float(np.abs(SLOW * change / accelerations).max()))
    return worst


def _image(values: Array, names: tuple[str, ...], partners: Mapping[str, str], negated: set[str]) -> Array:
    """Return the mirror image (n,) of values by joint."""
    at = {name: i for i, name in enumerate(names)}
    return np.array([(-1.0 if n in negated else 1.0) * values[at[partners.get(n, n)]] for n in names])
