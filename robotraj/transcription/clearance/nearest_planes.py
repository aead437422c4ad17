"""Planes between the nearest shapes at the knots of a motion, for rows whose planes change from solve to solve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj.dynamics.obstacles.primitives import primitives_of
from robotraj.native.build import load_native
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.robot.collision.placements import joint_tree, placements


class Planes(NamedTuple):
    """Planes n' p = offset of the nearest pairs of each group.

    Attributes
    ----------
    first_distances : ndarray (n,)
        Distances of all pairs of the groups at the first configuration [m], infinite for other pairs.
    pairs : tuple of ndarray of int (m, count)
        The nearest pairs of each group, the nearest first.
    planes : tuple of ndarray (m, count, 4)
        Normals and offsets [m]. Joints that move both shapes are neutral, as in ``distance_functions``.
    """

    first_distances: Array
    pairs: tuple[Indices, ...]
    planes: tuple[Array, ...]


class NearestPlanes:
    """The nearest pairs of groups of pairs with one distance function, and the planes between them.

    Parameters
    ----------
    pairs : ClearancePairs
    groups : sequence of ndarray of int
        Pairs of each group, against obstacles or between two joints.
    counts : sequence of int
        Number of pairs of each group that are found.
    """

    def __init__(self, pairs: ClearancePairs, groups: Sequence[Indices], counts: Sequence[int]) -> None:
        self._pairs, self._counts = pairs, list(counts)
        self._order = np.concatenate(groups)
        self._sizes = [len(group) for group in groups]
        shapes, spheres = primitives_of(pairs.obstacles), pairs.spheres
        rotations, _ = placements(pairs.robot, pairs.robot.neutral[None])
        common = [self._common(group) for group in groups]
        ends, against = np.cumsum(self._sizes), [int(group[0]) < pairs.against for group in groups]
        numbers = [
            (end, count, not first, joint)
            for end, count, first, joint in zip(ends, counts, against, common, strict=True)
        ]
        poses = [shapes.rotations.reshape(-1, 9), shapes.positions, shapes.dimensions]
        self._found = load_native().NearestPlanes(
            spheres.joint.astype(np.int64),
            np.column_stack([spheres.centre, spheres.radius]).ravel(),
            shapes.kinds.astype(np.int64),
            np.hstack(poses).ravel(),
            np.array([len(triangles) for triangles in shapes.triangles], dtype=np.int64),
            np.concatenate([np.zeros(0), *(triangles.ravel() for triangles in shapes.triangles)]),
            pairs.first[self._order].astype(np.int64),
            pairs.second[self._order].astype(np.int64),
            np.array(numbers, dtype=np.int64).ravel(),
            rotations[0, common].ravel(),
        )

    def along(self, q: Array, times: Array) -> Planes:
        """Return the planes at configurations (m, nq), with moving obstacles at times (m,) [s]."""
        rotations, origins = placements(self._pairs.robot, q)
        obstacles = [obstacle.poses(times) for obstacle in self._pairs.obstacles]
        poses = [np.concatenate([turned.reshape(-1, 9), at], axis=1) for at, turned in obstacles]
        places = np.concatenate([rotations.reshape(*origins.shape[:2], 9), origins], axis=2)
        distances, chosen, planes = self._found.find(
            places.ravel(), np.stack(poses, axis=1).ravel() if poses else np.zeros(0), len(q)
        )
        first, cuts = np.full(len(self._pairs), np.inf), np.cumsum(self._counts)[:-1]
        first[self._order] = distances
        return Planes(
            first,
            tuple(np.split(self._order[chosen].reshape(len(q), -1), cuts, axis=1)),
            tuple(np.split(planes.reshape(len(q), -1, 4), cuts, axis=1)),
        )

    def _common(self, group: Indices) -> int:
        """Return the last joint that moves both shapes of the pairs of a group alike, 0 for none."""
        pairs, pair = self._pairs, int(group[0])
        if pair < pairs.against:
            return 0
        joint = pairs.spheres.joint
        both = joint_tree(pairs.robot).moving_both(int(joint[pairs.first[pair]]), int(joint[pairs.second[pair]]))
        return int(both[-1]) if both.size else 0
