"""Moving obstacles for path planners: distances at given times, and copies at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.problem.clearance.sphere_tree import sphere_tree

if TYPE_CHECKING:
    from robotraj.native._native import SphereTree
    from robotraj.robot.collision.robot_spheres import RobotSpheres
    from robotraj.robot.robot import Robot


COPIES = 6
"""Number of times at which copies of obstacles are placed."""
CUSHION = 0.02
"""Largest distance beyond the margin [m], which allows for the motion between two times."""


@dataclass(frozen=True, eq=False)
class MovingScene:
    """A robot among moving obstacles and obstacles at rest.

    Attributes
    ----------
    robot : Robot
    spheres : RobotSpheres
    pairs : ndarray of int (m, 2)
        Links that may not touch.
    still, moving : sequence of Obstacle
    """

    robot: Robot
    spheres: RobotSpheres
    pairs: NDArray[np.int_]
    still: Sequence[Obstacle]
    moving: Sequence[Obstacle]

    def clearances(self, q: Array, times: Array) -> Array:
        """Return the least distance (n, m) [m] from moving obstacles, for configurations (n, nq) and times (m,) [s]."""
        carried = self.spheres.joint > 0
        centres = self.spheres.centres(self.robot, q)[:, carried]
        radius = self.spheres.radius[carried]
        found = np.full((len(q), len(times)), np.inf)
        for obstacle in self.moving:
            for k, (position, rotation) in enumerate(zip(*obstacle.poses(times), strict=True)):
                local = (centres - position) @ rotation
                apart = obstacle.distance(local.reshape(-1, 3)).reshape(centres.shape[:2]) - radius
                found[:, k] = np.minimum(found[:, k], apart.min(axis=1, initial=np.inf))
        return found

    def are_free(self, q: Array, times: Array, t0: float, margin: float) -> NDArray[np.bool_]:
        """Whether each configuration keeps a margin [m] at each time after t0 [s], (n, m)."""
        return np.asarray(self.clearances(q, t0 + times) > margin)

    def cushion(self, start: Array, t0: float, margin: float) -> float:
        """Return the distance beyond the margin [m] for planning, at most half of that of the start at t0 [s]."""
        left = float(self.clearances(start[None], np.array([t0]))[0, 0]) - margin
        return min(CUSHION, 0.5 * max(left, 0.0))

    def frozen(self, margin: float, t0: float, until: float, *ends: Array) -> SphereTree:
        """Compile the robot with copies at rest of the moving obstacles at several times.

        Copies that are too near to an end are omitted.

        Parameters
        ----------
        margin : float
            Least distance from the ends [m].
        t0, until : float
            First and last time of the copies [s].
        *ends : ndarray (nq,)
            Configurations at the ends.
        """
        copies = []
        for obstacle in self.moving:
            for t in np.linspace(t0, until, COPIES):
                position, rotation = obstacle.pose(float(t))
                quaternion = pin.Quaternion(np.array(rotation)).coeffs()
                pose = {"position": tuple(position), "quaternion": tuple(quaternion)}
                copy: Obstacle = replace(obstacle, **pose)  # type: ignore[type-var]
                alone = replace(self, moving=(copy,))
                if alone.clearances(np.array(ends), np.zeros(1)).min() > margin + CUSHION:
                    copies.append(copy)
        return sphere_tree(self.robot, self.spheres, self.pairs, [*self.still, *copies])
