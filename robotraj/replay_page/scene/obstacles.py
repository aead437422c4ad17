"""The obstacles that a replay shows: at rest, on a frame of the robot, or moving in time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import meshcat
import numpy as np
import pinocchio as pin
from meshcat.animation import AnimationClip

from robotraj._util.arrays import Array
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.coal_shapes import coal_shape
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.replay_page.scene.hull import INSTANTS
from robotraj.replay_page.scene.motion import keys
from robotraj.replay_page.scene.shapes import shape_part
from robotraj.replay_page.scene.window import PackedTrack, draw
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import GaitCycles

COLOR = (0.85, 0.55, 0.30, 1.0)


def draw_obstacles(
    viewer: meshcat.Visualizer,
    robot: Robot,
    cycles: GaitCycles,
    paths: Sequence[str],
    times: Array,
    fps: int,
    start: float,
) -> dict[str, AnimationClip]:
    """Draw the obstacles of every ``CollisionFree``, each once; return the clips of those that move, by their nodes.

    Parameters
    ----------
    viewer : meshcat.Visualizer
    robot : Robot
    cycles : GaitCycles
    paths : sequence of str
        Node of each joint.
    times : ndarray (m,)
        Times of the animation [s].
    fps : int
    start : float
        Time of the animation's first frame [s].
    """
    clips = {}
    for number, obstacle in enumerate(_obstacles(cycles)):
        part = shape_part(coal_shape(obstacle))
        if part is None:
            continue
        placement, parent = np.eye(4), "obstacles"
        if obstacle.frame is not None:
            frame = robot.model.frames[robot.frame(obstacle.frame)]
            placement, parent = np.array(frame.placement.homogeneous), paths[frame.parentJoint]
        position, rotation = obstacle.pose(float(times[0]))
        placement = placement @ pin.SE3(np.array(rotation), np.array(position)).homogeneous
        path = f"{parent}/obstacle {number}"
        viewer[path].set_transform(placement)
        draw(viewer[path], part, COLOR)
        if obstacle.moves:
            clips[path] = _clip(obstacle, times, fps, start)
    return clips


def surroundings(robot: Robot, cycles: GaitCycles, world: Array, times: Array, low: Array, high: Array) -> Array:
    """Return corners (k, 3) [m] around the obstacles near the robot, which the camera frames with it.

    An obstacle is near if it meets the box around the motion, grown by half of its diagonal on every side. What lies
    outside that box is cut off, so that a floor or a far wall does not make the robot small.

    Parameters
    ----------
    robot : Robot
    cycles : GaitCycles
    world : ndarray (m, njoints, 4, 4)
        Joint frames at the times.
    times : ndarray (m,)
    low, high : ndarray (3,)
        Corners of the box around the robot's motion [m].
    """
    far = 0.5 * float(np.linalg.norm(high - low))
    low, high = low - far, high + far
    picks = np.unique(np.linspace(0, len(times) - 1, INSTANTS).astype(int))
    found = [np.empty((0, 3))]
    for obstacle in _obstacles(cycles):
        part = None if obstacle.kind == "half space" else shape_part(coal_shape(obstacle))
        if part is None:
            continue
        frame = None if obstacle.frame is None else robot.model.frames[robot.frame(obstacle.frame)]
        for k in picks if obstacle.moves or frame is not None else picks[:1]:
            position, rotation = obstacle.pose(float(times[k]))
            points = part.vertices @ np.array(rotation).T + np.array(position)
            if frame is not None:
                placed = world[k, frame.parentJoint] @ np.array(frame.placement.homogeneous)
                points = points @ placed[:3, :3].T + placed[:3, 3]
            ends = np.array([points.min(axis=0), points.max(axis=0)])
            if np.all(ends[0] <= high) and np.all(ends[1] >= low):
                ends = np.clip(ends, low, high)
                found.append(np.array(list(product(*ends.T))))
    return np.concatenate(found)


def _obstacles(cycles: GaitCycles) -> Iterator[Obstacle]:
    seen: dict[int, Obstacle] = {}
    for result in cycles.phases:
        for constraint in result.phase.constraints:
            for obstacle in constraint.obstacles if isinstance(constraint, CollisionFree) else ():
                if id(obstacle) not in seen:
                    seen[id(obstacle)] = obstacle
                    yield obstacle


def _clip(obstacle: Obstacle, times: Array, fps: int, start: float) -> AnimationClip:
    """Return the motion of an obstacle as keys."""
    positions, rotations = obstacle.poses(times)
    quaternions = np.array([pin.Quaternion(np.array(rotation)).coeffs() for rotation in rotations])
    flips = np.cumsum(np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0) % 2 == 1
    quaternions[1:][flips] *= -1.0
    chosen, clip = keys(positions, quaternions), AnimationClip(fps=fps)
    frames = (times - start) * fps
    for name, kind, values in (("position", "vector3", positions), ("quaternion", "quaternion", quaternions)):
        clip.tracks[name] = PackedTrack(name, kind, frames[chosen], values[chosen])
    return clip
