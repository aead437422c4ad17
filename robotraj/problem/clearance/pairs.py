"""Pairs of shapes between which a phase keeps a margin: spheres of the robot and obstacles, and spheres of two links.

Shapes that no joint moves relative to each other form no pair. Obstacles on a frame of the robot are enclosed by
spheres (``carried_obstacles``), and form pairs as links do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array, Indices
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.primitives import labels_of
from robotraj.problem.clearance.carried_obstacles import with_carried_obstacles
from robotraj.problem.clearance.sphere_tree import sphere_tree
from robotraj.robot.collision.lever_arms import levers, relative_levers
from robotraj.robot.collision.link_pairs import always_touching
from robotraj.robot.collision.robot_spheres import RobotSpheres, robot_spheres
from robotraj.robot.collision.unguarded import no_shapes
from robotraj.robot.robot import Robot

if TYPE_CHECKING:
    from robotraj.native._native import SphereTree


@dataclass(frozen=True, eq=False)
class ClearancePairs(OneLine):
    """The pairs of a ``CollisionFree`` as plain arrays.

    Attributes
    ----------
    robot : Robot
    spheres : RobotSpheres
        Spheres of the robot and of the obstacles that it carries.
    obstacles : tuple of Obstacle
        Obstacles in the world.
    labels : tuple of str
        Names of ``obstacles``.
    margin : float
        Least distance [m].
    first : ndarray of int (n,)
        Sphere of each pair.
    second : ndarray of int (n,)
        Obstacle of the first ``against`` pairs, sphere of the others.
    against : int
        Number of pairs with an obstacle.
    """

    robot: Robot
    spheres: RobotSpheres
    obstacles: tuple[Obstacle, ...]
    labels: tuple[str, ...]
    margin: float
    first: Indices
    second: Indices
    against: int

    def __len__(self) -> int:
        return len(self.first)

    def names(self, pair: int) -> tuple[str, str]:
        """Return the names of both shapes of a pair: a link, and an obstacle or another link."""
        links, link = self.spheres.links, self.spheres.link
        other = int(self.second[pair])
        return links[link[self.first[pair]]], self.labels[other] if pair < self.against else links[link[other]]

    def label(self, pair: int) -> str:
        """Return ``"wrist_3_link and box"``."""
        return " and ".join(self.names(pair))

    def distances(self, q: Array, times: Array) -> Array:
        """Return the distances of all pairs (m, n) [m] at configurations (m, nq) and times (m,) [s]."""
        if self.tree is not None:
            found = self.tree.distances(np.ravel(q), *self._in_tree, self.against)
            return np.asarray(found.reshape(len(q), len(self)))
        out = np.empty((len(q), len(self)))
        centres = self.spheres.centres(self.robot, q)
        for number, obstacle in enumerate(self.obstacles):
            own = self._of_obstacle[number]
            if own.size:
                out[:, own] = self._from_obstacle(obstacle, centres[:, self.first[own]], times)
            out[:, own] -= self.spheres.radius[self.first[own]]
        if self.own_tree is not None and len(self) > self.against:
            first, second = (part[self.against :] for part in self._in_tree)
            out[:, self.against :] = self.own_tree.distances(np.ravel(q), first, second, 0).reshape(len(q), -1)
            return out
        a, b = self.first[self.against :], self.second[self.against :]
        out[:, self.against :] = np.linalg.norm(centres[:, a] - centres[:, b], axis=2)
        out[:, self.against :] -= self.spheres.radius[a] + self.spheres.radius[b]
        return out

    def distances_of(self, pairs: Indices, q: Array, times: Array) -> Array:
        """Return the distance (m,) [m] of one pair at each configuration (m, nq) and time (m,) [s]."""
        centres, radius = self.spheres.centres(self.robot, q), self.spheres.radius
        which = np.arange(len(pairs))
        here = centres[which, self.first[pairs]]
        out = np.empty(len(pairs))
        own = pairs >= self.against
        there = centres[which[own], self.second[pairs[own]]]
        out[own] = np.linalg.norm(here[own] - there, axis=1) - radius[self.second[pairs[own]]]
        for number, obstacle in enumerate(self.obstacles):
            chosen = np.flatnonzero(~own & (self.second[pairs] == number))
            if chosen.size:
                out[chosen] = self._from_obstacle(obstacle, here[chosen, None], times[chosen])[:, 0]
        return np.asarray(out - radius[self.first[pairs]])

    def centres_of(self, spheres: Indices, q: Array) -> Array:
        """Return the centre in the world (m, 3) [m] of one sphere at each configuration (m, nq)."""
        if self.own_tree is not None:
            return self.own_tree.centres(np.ravel(q), self._ranks[spheres]).reshape(len(q), 3)
        return np.asarray(self.spheres.centres(self.robot, q)[np.arange(len(q)), spheres])

    def with_obstacles(self, obstacles: Sequence[Obstacle]) -> ClearancePairs:
        """Return the pairs with other obstacles, as many and in the same order; they share the compiled robot."""
        other = replace(self, obstacles=tuple(obstacles))
        for name in ("own_tree", "_ranks", "_in_tree"):
            vars(other)[name] = getattr(self, name)
        return other

    @cached_property
    def tree(self) -> SphereTree | None:
        """The compiled shapes; None if an obstacle moves in time or the robot's base moves."""
        if not self.obstacles:
            return self.own_tree
        if not self._compiles or any(o.moves for o in self.obstacles):
            return None
        apart = self.spheres.link_pairs if len(self) > self.against else self.spheres.link_pairs[:0]
        return sphere_tree(self.robot, self.spheres, apart, self.obstacles)

    @cached_property
    def own_tree(self) -> SphereTree | None:
        """The compiled spheres of the robot without obstacles; None if its base moves."""
        if not self._compiles:
            return None
        apart = self.spheres.link_pairs if len(self) > self.against else self.spheres.link_pairs[:0]
        return sphere_tree(self.robot, self.spheres, apart, ())

    @property
    def _compiles(self) -> bool:
        """Whether every joint has one position of its own and the base does not move."""
        return self.robot.root == "fixed" and self.robot.nq == self.robot.nv and not self.robot.followers

    @cached_property
    def numbers(self) -> Mapping[tuple[int, int, bool], int]:
        """Number of each pair by its two indices in ``tree`` and whether it consists of two spheres."""
        first, second = (part.tolist() for part in self._in_tree)
        return {(a, b, k >= self.against): k for k, (a, b) in enumerate(zip(first, second, strict=True))}

    @cached_property
    def _ranks(self) -> NDArray[np.int64]:
        """Index of every sphere in ``tree``, which sorts spheres by link."""
        ranks = np.empty(len(self.spheres.link), dtype=np.int64)
        ranks[np.argsort(self.spheres.link, kind="stable")] = np.arange(len(ranks))
        return ranks

    @cached_property
    def _in_tree(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        others = np.append(self.second[: self.against], self._ranks[self.second[self.against :]])
        return self._ranks[self.first], others.astype(np.int64)

    def _from_obstacle(self, obstacle: Obstacle, points: Array, times: Array) -> Array:
        """Signed distances (m, n) of points (m, n, 3) from an obstacle."""
        positions, rotations = obstacle.poses(times)
        local = (points - positions[:, None]) @ rotations
        return obstacle.distance(local.reshape(-1, 3)).reshape(points.shape[:2])

    @cached_property
    def _of_obstacle(self) -> list[Indices]:
        against = self.second[: self.against]
        return [np.flatnonzero(against == number) for number in range(len(self.obstacles))]

    @cached_property
    def speed_factors(self) -> Array:
        """Bounds (n, nv): the distance of a pair changes by at most ``speed_factors @ abs(v)`` a second [m]."""
        spheres, (a, b) = self.spheres, (self.first[self.against :], self.second[self.against :])
        own = levers(self.robot, spheres.joint, spheres.centre)
        factors = own[self.first]
        factors[self.against :] = relative_levers(self.robot, spheres.joint, spheres.centre, a, b)
        return factors

    @cached_property
    def of_links(self) -> Indices:
        """Number (n,) of the link and the obstacle, or of the two links, to which the shapes of each pair belong."""
        link = self.spheres.link
        obstacle = np.arange(len(self)) < self.against
        other = np.where(obstacle, self.second, len(self.obstacles) + link[np.where(obstacle, 0, self.second)])
        _, numbers = np.unique(np.column_stack([link[self.first], other]), axis=0, return_inverse=True)
        return numbers.ravel()


def clearance_pairs(
    robot: Robot,
    obstacles: Sequence[Obstacle],
    margin: float,
    self_collision: bool,
    disabled: Sequence[tuple[str, str]],
) -> ClearancePairs:
    """Return the pairs of a robot and obstacles.

    Raises
    ------
    InputError
        The robot has no collision shapes, an obstacle names an unknown frame, or one on a frame moves or is unbounded.
    """
    spheres = robot_spheres(robot, disabled)
    if not len(spheres.radius):
        raise InputError(no_shapes(robot))
    labels = labels_of(obstacles)
    carried = [(o, label) for o, label in zip(obstacles, labels, strict=True) if o.frame is not None]
    if carried:
        spheres = with_carried_obstacles(robot, spheres, carried, disabled)
    still = [(o, label) for o, label in zip(obstacles, labels, strict=True) if o.frame is None]
    moving = np.flatnonzero(spheres.joint > 0)
    first, second = [np.zeros(0, dtype=int)], [np.zeros(0, dtype=int)]
    for number, (obstacle, _) in enumerate(still):
        # The distance between a fixed base and an obstacle at rest cannot change.
        own = np.arange(len(spheres.radius)) if obstacle.moves else moving
        first.append(own)
        second.append(np.full(len(own), number))
    against = sum(map(len, first))
    if self_collision:
        if margin > 0.0:
            spheres = replace(spheres, link_pairs=spheres.link_pairs[~always_touching(robot, spheres, margin)])
        first.append(spheres.sphere_pairs[:, 0])
        second.append(spheres.sphere_pairs[:, 1])
    return ClearancePairs(
        robot,
        spheres,
        tuple(obstacle for obstacle, _ in still),
        tuple(label for _, label in still),
        margin,
        np.concatenate(first),
        np.concatenate(second),
        against,
    )
