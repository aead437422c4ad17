"""The robot's own body: its exact shapes, the pairs of them that must not overlap, and what cannot be judged.

Three kinds of pairs are not judged. A joint connects their links, or nothing moves them relative to each other; an SRDF
disables them; or they overlap by construction, in the neutral configuration and in many others. Where a file names the
configuration in which a robot with a free root stands, shapes that overlap there are larger than their links.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.lazy_values import cached_property
from robotraj._util.precision import ROUND_OFF
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.collision.lever_arms import (
    across_pairs,
    joints_of_rates,
    levers_across,
    levers_by_rate,
    per_velocity,
)
from robotraj.robot.collision.link_pairs import candidate_pairs, sampled_configurations
from robotraj.robot.collision.placements import joint_tree, placements
from robotraj.robot.collision.solids import UNBOUNDED, Placed, Solid, depth, distance, one_inside, touch
from robotraj.robot.collision.unguarded import unguarded_links
from robotraj.robot.neutral import inside
from robotraj.robot.per_robot import PerRobot
from robotraj.robot.robot import Robot

SAMPLED = 60
"""Number of configurations in which pairs that overlap in the neutral one are compared."""
OFTEN = 0.15
"""Share of these configurations above which an overlap is one by construction."""
CONSTRUCTED, DISABLED = "they overlap in the neutral configuration by construction", "the SRDF disables them"


@dataclass(frozen=True, eq=False)
class OwnBody(OneLine):
    """The exact shapes of a robot.

    Attributes
    ----------
    links : tuple of str
        Link of each shape.
    solids : tuple of Solid
    joint : ndarray of int (n,)
        Pinocchio's joint that carries each shape; 0 for the world.
    rotation, position : ndarray (n, 3, 3), (n, 3)
        Placement of each shape in its joint's frame [m].
    pairs : ndarray of int (m, 2)
        Pairs of shapes that are judged.
    factors : ndarray (m, nv)
        Two shapes approach each other by at most ``factors @ abs(v)`` a second [m].
    left_out : tuple of (str, str)
        Pairs of links that are not judged, ``"base and torso"``, each with the reason. Neighbours are not listed.
    unguarded : tuple of (str, str)
        Links whose shapes are missing, each with the reason.
    """

    links: tuple[str, ...]
    solids: tuple[Solid, ...]
    joint: Indices
    rotation: Array
    position: Array
    pairs: Indices
    factors: Array
    left_out: tuple[tuple[str, str], ...]
    unguarded: tuple[tuple[str, str], ...]

    def label(self, pair: int) -> str:
        """Return ``"forearm and wrist"``."""
        return " and ".join(self.links[shape] for shape in self.pairs[pair])

    @cached_property
    def balls(self) -> tuple[Indices, Array, Array]:
        """Shape (n,) of each of the balls around all shapes, its centre (n, 3) in its joint's frame and radius [m]."""
        every = [solid.balls for solid in self.solids]
        shape = np.repeat(np.arange(len(every)), [len(radii) for _, radii in every])
        own = np.concatenate([np.zeros((0, 3)), *(centres for centres, _ in every)])
        centres = np.einsum("nij,nj->ni", self.rotation[shape], own) + self.position[shape]
        return shape, centres, np.concatenate([np.zeros(0), *(radii for _, radii in every)])

    @cached_property
    def outer_balls(self) -> tuple[Array, Array]:
        """One ball around all balls of each shape: its centre (m, 3) in the joint's frame and radius (m,) [m]."""
        shape, centres, radii = self.balls
        found = np.zeros((len(self.solids), 3)), np.zeros(len(self.solids))
        for number in range(len(self.solids)):
            own = centres[shape == number]
            found[0][number] = 0.5 * (own.min(axis=0) + own.max(axis=0))
            reach = np.linalg.norm(own - found[0][number], axis=1) + radii[shape == number]
            found[1][number] = (1.0 + ROUND_OFF) * reach.max()
        return found

    @cached_property
    def farthest(self) -> Array:
        """The point (n, 3) of each shape's hull that is furthest from its joint's origin, in that frame [m]."""
        points = [
            solid.outer_points @ turn.T + at
            for solid, turn, at in zip(self.solids, self.rotation, self.position, strict=True)
        ]
        return np.array([each[np.argmax(np.linalg.norm(each, axis=1))] for each in points]).reshape(-1, 3)

    @cached_property
    def ball_pairs(self) -> tuple[Indices, Indices]:
        """Pairs of balls (k, 2) of all judged pairs of shapes, one after the other, and the first one of each (m,)."""
        shape = self.balls[0]
        of_shape = [np.flatnonzero(shape == number) for number in range(len(self.solids))]
        parts = [np.stack(np.meshgrid(of_shape[a], of_shape[b]), axis=-1).reshape(-1, 2) for a, b in self.pairs]
        counts = np.array([len(part) for part in parts], dtype=int)
        return np.concatenate([np.zeros((0, 2), dtype=int), *parts]), np.cumsum(counts) - counts

    def near_by_balls(
        self, pair: Indices, which: Indices, rotations: Array, origins: Array, margins: Array | float = 0.0
    ) -> Indices:
        """Return which pairs of shapes (n,) have balls within margins [m] at configurations ``which`` (n,) of m.

        The joints have rotations (m, njoints, 3, 3) and origins (m, njoints, 3) there. Most pairs are far apart already
        by one ball around each shape.
        """
        margins = np.broadcast_to(margins, len(pair))
        centres, radii = self.outer_balls
        outer = np.einsum("mnij,nj->mni", rotations[:, self.joint], centres) + origins[:, self.joint]
        a, b = self.pairs[pair].T
        near = np.flatnonzero(_gaps(outer[which, a], outer[which, b], radii[a] + radii[b]) <= margins)
        if not len(near):
            return near
        shape, centres, radii = self.balls
        joint = self.joint[shape]
        inner = np.einsum("mnij,nj->mni", rotations[:, joint], centres) + origins[:, joint]
        every, first = self.ball_pairs
        counts = np.diff(np.append(first, len(every)))[pair[near]]
        begin = np.cumsum(counts) - counts
        a, b = every[np.arange(counts.sum()) + np.repeat(first[pair[near]] - begin, counts)].T
        when = np.repeat(which[near], counts)
        gaps = _gaps(inner[when, a], inner[when, b], radii[a] + radii[b])
        return near[np.minimum.reduceat(gaps, begin) <= margins[near]]

    def placed(self, shape: int, rotations: Array, origins: Array) -> Placed:
        """Place a shape in the world by the rotations (njoints, 3, 3) and origins (njoints, 3) [m] of joints."""
        turn, at = rotations[self.joint[shape]], origins[self.joint[shape]]
        return Placed(self.solids[shape], turn @ self.rotation[shape], turn @ self.position[shape] + at)

    def placed_along(self, shape: int, rotations: Array, origins: Array) -> list[Placed]:
        """Place a shape at m configurations, by rotations (m, njoints, 3, 3) and origins (m, njoints, 3) [m]."""
        turns, at = rotations[:, self.joint[shape]], origins[:, self.joint[shape]]
        places = zip(turns @ self.rotation[shape], turns @ self.position[shape] + at, strict=True)
        return [Placed(self.solids[shape], *place) for place in places]

    def touching(self, robot: Robot, q: Array) -> list[int]:
        """Return the pairs that overlap in a configuration (nq,), also by one shape inside the other."""
        rotations, origins = placements(robot, q[None])
        every = np.arange(len(self.pairs))
        near = self.near_by_balls(every, np.zeros_like(every), rotations, origins)
        shapes = np.unique(self.pairs[near]).tolist()
        placed = {shape: self.placed(shape, rotations[0], origins[0]) for shape in shapes}
        return [
            number
            for number, (a, b) in zip(near.tolist(), self.pairs[near].tolist(), strict=True)
            if touch(placed[a], placed[b]) or one_inside(placed[a], placed[b])
        ]

    def depth(self, robot: Robot, q: Array, pair: int) -> float:
        """Return the depth of an overlapping pair in a configuration (nq,) [m]."""
        return depth(*self._placed_pair(robot, q, pair))

    def distance(self, robot: Robot, q: Array, pair: int) -> float:
        """Return the distance of the surfaces of a pair in a configuration (nq,) [m]."""
        return distance(*self._placed_pair(robot, q, pair))

    def _placed_pair(self, robot: Robot, q: Array, pair: int) -> tuple[Placed, Placed]:
        rotations, origins = (each[0] for each in placements(robot, q[None]))
        first, second = self.pairs[pair].tolist()
        return self.placed(first, rotations, origins), self.placed(second, rotations, origins)


def _gaps(first: Array, second: Array, radii: Array) -> Array:
    """Return the distances (n,) of balls with centres (n, 3) and both radii (n,) together [m]."""
    apart = first - second
    return np.asarray(np.sqrt(np.einsum("ni,ni->n", apart, apart)) - radii)


_KNOWN: PerRobot[OwnBody] = PerRobot()


def own_body(robot: Robot, disabled: Collection[tuple[str, str]] = ()) -> OwnBody:
    """Return the exact shapes of a robot; they are computed once per robot.

    Parameters
    ----------
    robot : Robot
    disabled : collection of (str, str)
        Pairs of links that are not judged, as of ``read_srdf``.

    Raises
    ------
    InputError
        The file of the shapes is gone, or a joint is neither revolute, prismatic nor a free-flyer.
    """
    key = frozenset(frozenset(pair) for pair in disabled)
    return _KNOWN.get(robot, key, lambda: _made(robot, disabled))


def body_between(robot: Robot, first: Callable[[str], bool]) -> OwnBody:
    """Return the shapes of a robot, with the pairs of links of which ``first`` accepts one name and not the other."""
    body = own_body(robot)
    own = np.array([first(link) for link in body.links], dtype=bool)
    pairs = [(i, j) for i in np.flatnonzero(own).tolist() for j in np.flatnonzero(~own).tolist()]
    moving = _numbers([(i, j) for i, j in pairs if body.joint[i] or body.joint[j]])
    return replace(body, pairs=moving, factors=_factors(robot, body, moving), left_out=())


def _made(robot: Robot, disabled: Collection[tuple[str, str]]) -> OwnBody:
    shapes, model = list(robot.collision_model.geometryObjects), robot.model
    links = tuple(model.frames[shape.parentFrame].name for shape in shapes)
    joint = np.array([int(shape.parentJoint) for shape in shapes], dtype=int)
    rotation = np.array([shape.placement.rotation for shape in shapes]).reshape(-1, 3, 3)
    position = np.array([shape.placement.translation for shape in shapes]).reshape(-1, 3)
    solids = tuple(Solid(shape.geometry) for shape in shapes)
    every = {frozenset(pair) for pair in candidate_pairs(robot, list(dict.fromkeys(links)))}
    named = {frozenset(pair) for pair in disabled}
    among = [(i, j) for i in range(len(links)) for j in range(i) if frozenset((links[i], links[j])) in every - named]
    left_out = [(" and ".join(sorted(pair)), DISABLED) for pair in every & named]
    whole = OwnBody(
        links, solids, joint, rotation, position, _numbers(among), np.zeros((0, 0)), (), unguarded_links(robot)
    )
    constructed = _by_construction(robot, whole)
    left_out += [(" and ".join(sorted(pair)), CONSTRUCTED) for pair in constructed]
    kept = _numbers([(i, j) for i, j in among if frozenset((links[i], links[j])) not in constructed])
    factors = _factors(robot, whole, kept)
    return OwnBody(links, solids, joint, rotation, position, kept, factors, tuple(sorted(left_out)), whole.unguarded)


def _numbers(pairs: list[tuple[int, int]]) -> Indices:
    return np.array(pairs, dtype=int).reshape(-1, 2)


def _by_construction(robot: Robot, body: OwnBody) -> set[frozenset[str]]:
    """Return the pairs of links that overlap in the neutral configuration and often in others.

    Those of a robot that stands in its neutral configuration overlap by construction in any case.
    """
    open_ = body.touching(robot, robot.neutral)
    if not open_:
        return set()
    if _stands(robot):
        return {frozenset(body.links[shape] for shape in body.pairs[pair].tolist()) for pair in open_}
    counts: Counter[frozenset[str]] = Counter()
    pairs = body.pairs[open_]
    rotations, origins = placements(robot, sampled_configurations(robot, SAMPLED))
    for turned, moved in zip(rotations, origins, strict=True):
        placed = {shape: body.placed(shape, turned, moved) for shape in np.unique(pairs).tolist()}
        hit = [(a, b) for a, b in pairs.tolist() if touch(placed[a], placed[b])]
        counts.update({frozenset((body.links[a], body.links[b])) for a, b in hit})
    return {pair for pair, count in counts.items() if count > OFTEN * SAMPLED}


def _stands(robot: Robot) -> bool:
    """Whether a robot with a free root stands in its neutral configuration: its file names one other than zero."""
    count = robot.nv - robot.limits.free
    zero = inside(np.zeros(robot.nq), robot.limits)[-count:]
    return robot.root == "floating" and count > 0 and not np.array_equal(robot.neutral[-count:], zero)


def _factors(robot: Robot, body: OwnBody, pairs: Indices) -> Array:
    reach, across = levers_by_rate(robot, body.joint, body.farthest), levers_across(robot, body.joint, body.farthest)
    tree, rates = joint_tree(robot), joints_of_rates(robot)
    for shape, solid in enumerate(body.solids):
        points = solid.outer_points @ body.rotation[shape].T + body.position[shape]
        for j in np.flatnonzero(tree.turns).tolist():
            column = int(np.searchsorted(rates, j))
            # The axis of a shape's own joint, and of those that it carries, is fixed in its frame.
            if j == body.joint[shape]:
                reach[shape, column] = _from_axis(points, tree.axes[j])
            elif tree.parents[j] == body.joint[shape]:
                axis = tree.rotations[j] @ tree.axes[j]
                across[shape, column] = _from_axis(points - tree.translations[j], axis)
    a, b = pairs.T
    one, other = np.minimum(reach[a], across[b]), np.minimum(reach[b], across[a])
    # Joints that carry both shapes alike do not change their distance.
    return per_velocity(robot, across_pairs(robot, body.joint, a, b, one, other))


def _from_axis(points: Array, axis: Array) -> float:
    """Return the largest distance of points (n, 3) from an axis through the origin [m]; infinite if unbounded."""
    if not np.all(np.abs(points) < UNBOUNDED):
        return np.inf
    return float(np.linalg.norm(np.cross(points, axis), axis=1).max(initial=0.0))
