"""Pairs of links that are checked against each other.

Four kinds of pairs are not checked. An SRDF disables them, a joint connects the links, the links do not move relative
to each other, or their shapes touch in every configuration. Links that are nearer than a margin in every configuration
need not keep it; the witness checks that they do not touch.

A fifth kind is too close for spheres. The spheres around the forearm and the wrist of an arm overlap in half of its
configurations, while the shapes touch in few. The witness checks these pairs with the exact shapes.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Sequence
from itertools import combinations, product
from typing import Protocol

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.paths import input_path
from robotraj.robot.robot import Robot
from robotraj.robot.urdf.xml import read_xml

Pairs = tuple[tuple[str, str], ...]

SAMPLES = 300
"""Configurations in which a pair must touch to count as always touching."""
OFTEN = 0.15
"""Fraction of configurations with touching spheres above which the exact shapes of a pair are compared."""
AGREEING = 0.5
"""Least fraction of these configurations in which the exact shapes must touch too."""


def read_srdf(path: str | os.PathLike[str]) -> Pairs:
    """Return the pairs of links that an SRDF disables.

    Raises
    ------
    InputError
        The file cannot be read, or an entry names no two links.
    """
    pairs = []
    for entry in read_xml(input_path(path, "The SRDF file"), "SRDF").iter("disable_collisions"):
        first, second = entry.get("link1"), entry.get("link2")
        if not first or not second:
            raise InputError(f"{str(path)!r}: an entry <disable_collisions> names no link1 and link2; complete it.")
        pairs.append((first, second))
    return tuple(pairs)


def candidate_pairs(
    robot: Robot, links: Sequence[str], disabled: Collection[tuple[str, str]] = ()
) -> list[tuple[str, str]]:
    """Return pairs of links that move relative to each other and are neither joined nor disabled.

    Parameters
    ----------
    robot : Robot
    links : sequence of str
        Links that carry shapes.
    disabled : collection of (str, str)
        Pairs in either order; names of links that the robot lacks are ignored, since an SRDF may describe more.
    """
    model = robot.model
    frames = {link: robot.frame(link) for link in links}
    dropped = {frozenset(pair) for pair in disabled}
    found = []
    for first, second in combinations(links, 2):
        a, b = model.frames[frames[first]], model.frames[frames[second]]
        joined = frames[first] == _parent_link(model, frames[second]) or frames[second] == _parent_link(
            model, frames[first]
        )
        if a.parentJoint != b.parentJoint and not joined and frozenset((first, second)) not in dropped:
            found.append((first, second))
    return found


class Spheres(Protocol):
    """Spheres with the distances of pairs of links."""

    def self_distances(self, robot: Robot, q: Array) -> Array:
        """Return the distance [m] of each pair of links (configurations, pairs)."""


def always_touching(robot: Robot, spheres: Spheres, margin: float = 0.0) -> npt.NDArray[np.bool_]:
    """Return which pairs of links are nearer than ``margin`` [m] in all of ``sampled_configurations``, (pairs,)."""
    return np.asarray(np.all(spheres.self_distances(robot, sampled_configurations(robot)) < margin, axis=0))


def too_coarse(
    robot: Robot, links: Sequence[str], pairs: npt.NDArray[np.int_], spheres: Spheres
) -> npt.NDArray[np.bool_]:
    """Return which pairs of links touch by their spheres in many configurations, and by their shapes in few, (pairs,).

    Parameters
    ----------
    links : sequence of str
        Links that carry spheres.
    pairs : ndarray of int (m, 2)
        Indices in ``links``.
    """
    q = sampled_configurations(robot)
    share = np.mean(spheres.self_distances(robot, q) < 0.0, axis=0)
    found = share > OFTEN
    if not found.any():
        return np.asarray(found)
    shapes, data = robot.collision_model.copy(), robot.model.createData()
    shapes.removeAllCollisionPairs()
    on_link = [robot.model.frames[shape.parentFrame].name for shape in shapes.geometryObjects]
    owner = []
    for number in np.flatnonzero(found):
        first, second = (links[i] for i in pairs[number])
        for i, j in product(_all(on_link, first), _all(on_link, second)):
            shapes.addCollisionPair(pin.CollisionPair(i, j))
            owner.append(int(number))
    results = shapes.createData()
    touching = np.zeros((len(q), len(share)), dtype=bool)
    for k, each in enumerate(q):
        pin.computeCollisions(robot.model, data, shapes, results, each, False)
        for pair, result in zip(owner, results.collisionResults, strict=True):
            touching[k, pair] |= result.isCollision()
    return np.asarray(found & (touching.mean(axis=0) < AGREEING * share))


def _all(names: Sequence[str], name: str) -> list[int]:
    return [i for i, each in enumerate(names) if each == name]


def _parent_link(model: pin.Model, frame: int) -> int:
    """Return the link to which a joint joins a link, through frames that are joints; -1 where there is none."""
    at, before = int(model.frames[frame].parentFrame), frame
    # Pinocchio makes the frame of a locked joint its own parent; links beside it do not move relative to each other.
    while at != before and model.frames[at].type != pin.FrameType.BODY:
        at, before = int(model.frames[at].parentFrame), at
    return at if at != before else -1


def sampled_configurations(robot: Robot, count: int = SAMPLES) -> Array:
    """Return seeded random configurations within the position limits (count, nq); unlimited joints turn once."""
    rng = np.random.default_rng(0)
    limits = robot.limits
    lower, upper = (np.array(side, dtype=float) for side in (limits.position_lower, limits.position_upper))
    lower, upper = np.where(np.isfinite(lower), lower, -np.pi), np.where(np.isfinite(upper), upper, np.pi)
    v = lower + (upper - lower) * rng.random((count, robot.nv))
    if robot.nq == robot.nv:
        return np.asarray(v)
    # The placement of a floating root moves all links alike.
    return np.column_stack([np.tile(robot.neutral[: robot.nq - robot.nv + 6], (count, 1)), v[:, 6:]])
