"""The inertia of a robot compared with that of its mirror image."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.problem.links.periodic import Mirror
from robotraj.robot.robot import Robot

Array = NDArray[np.float64]

IMBALANCE = 8e-3
"""Largest difference of moments, relative to weight times size, of a robot that counts as symmetric."""
SAMPLES = 8
"""Number of seeded random configurations that are compared."""


def imbalance(robot: Robot, repeat: Mirror) -> float:
    """Return how far the mirror image of a balanced robot is from balance.

    For seeded random configurations q and their images q', the generalised gravity g(q') is compared with the image of
    g(q). The largest difference of the root's force, and of its moment about the root divided by the size of the robot,
    is returned relative to the weight. The size is the height of the centre of mass above the lowest joint, where the
    robot is neutral. A robot with a fixed or planar root is not compared: 0.
    """
    if robot.root != "floating":
        return 0.0
    model, data = robot.model, robot.model.createData()
    partners = {**repeat.partners, **{b: a for a, b in repeat.partners.items()}}
    negated = set(repeat.negated)
    com = np.array(pin.centerOfMass(model, data, robot.neutral))
    pin.forwardKinematics(model, data, robot.neutral)
    size = max(float(com[2]) - min(float(place.translation[2]) for place in list(data.oMi)[1:]), 1e-3)
    weight = pin.computeTotalMass(model) * float(np.linalg.norm(model.gravity.linear))
    rng, zero, worst = np.random.default_rng(0), np.zeros(robot.nv), 0.0
    root = slice(0, 6)
    for _ in range(SAMPLES):
        q = np.array(robot.neutral)
        q[7:] += rng.uniform(-0.5, 0.5, len(q) - 7)
        image = _image(q, robot.position_names, partners, negated)
        own = _image(pin.rnea(model, data, q, zero, zero), robot.velocity_names, partners, negated)
        gap = np.array(pin.rnea(model, data, image, zero, zero) - own)[root]
        worst = max(worst, float(np.linalg.norm(gap[:3])), float(np.linalg.norm(gap[3:])) / size)
    return worst / weight


def _image(values: Array, names: tuple[str, ...], partners: Mapping[str, str], negated: set[str]) -> Array:
    """Return the mirror image (n,) of values by joint."""
    at = {name: i for i, name in enumerate(names)}
    return np.array([(-1.0 if n in negated else 1.0) * values[at[partners.get(n, n)]] for n in names])
