"""The distance of the robot to the obstacles of a phase, along its motion."""

from __future__ import annotations

from typing import Any

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.robot.collision.robot_spheres import RobotSpheres, robot_spheres
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import CyclePhase, CycleSample
from robotraj.solution.sample import Sample


@dataclass(frozen=True, eq=False)
class NearestObstacle(OneLine):
    """Distances of the robot's spheres to the obstacles that are not attached to it.

    Attributes
    ----------
    robot : Robot
    spheres : RobotSpheres
    obstacles : tuple of Obstacle
    margin : float
        Largest distance that a constraint of the phase keeps [m].
    delay : float
        Time of the page less the time of the plan [s].
    """

    robot: Robot
    spheres: RobotSpheres
    obstacles: tuple[Obstacle, ...]
    margin: float
    delay: float

    def distances(self, sample: Sample[Any] | CycleSample) -> Array:
        """Return the least distance (m, 1) [m] at each time, negative inside an obstacle."""
        q, times = np.atleast_2d(sample.q), np.atleast_1d(sample.t) - self.delay
        moves = self.spheres.joint > 0
        centres, radius = self.spheres.centres(self.robot, q)[:, moves], self.spheres.radius[moves]
        found = np.full(len(q), np.inf)
        for obstacle in self.obstacles:
            positions, rotations = obstacle.poses(times)
            local = np.einsum("mni,mij->mnj", centres - np.asarray(positions)[:, None], np.asarray(rotations))
            apart = obstacle.distance(local.reshape(-1, 3)).reshape(local.shape[:2]) - radius
            found = np.minimum(found, apart.min(axis=1, initial=np.inf))
        return found[:, None]


def nearest_obstacle(cycle_phase: CyclePhase) -> NearestObstacle | None:
    """Return the distances of a phase; None where it has no obstacles in the world."""
    robot = cycle_phase.phase.robot
    imposed = [each for each in cycle_phase.phase.constraints if isinstance(each, CollisionFree)]
    around = {obstacle: None for each in imposed for obstacle in each.obstacles if obstacle.frame is None}
    if robot is None or not around:
        return None
    margin = max(each.margin for each in imposed)
    delay = cycle_phase.t0 - cycle_phase.planned.t0
    return NearestObstacle(cycle_phase.robot, robot_spheres(robot), tuple(around), margin, delay)
