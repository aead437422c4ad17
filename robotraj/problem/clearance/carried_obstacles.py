"""Obstacles on a frame of the robot: enclosed by spheres, and attached to the joint that carries them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.convex_mesh import ConvexMesh
from robotraj.dynamics.obstacles.shapes import Box, Capsule, Cylinder, Sphere
from robotraj.robot.collision.fit_cache import fitted
from robotraj.robot.collision.link_pairs import always_touching, candidate_pairs
from robotraj.robot.collision.robot_spheres import RobotSpheres, capsule_spheres
from robotraj.robot.collision.tessellation import box_triangles, cylinder_triangles, hull_triangles
from robotraj.robot.robot import Robot


def with_carried_obstacles(
    robot: Robot,
    spheres: RobotSpheres,
    carried: Sequence[tuple[Obstacle, str]],
    disabled: Sequence[tuple[str, str]],
) -> RobotSpheres:
    """Add the spheres of carried obstacles to those of a robot, each obstacle as a further link.

    Parameters
    ----------
    robot : Robot
    spheres : RobotSpheres
        Spheres of the robot.
    carried : sequence of (Obstacle, str)
        Obstacles on frames of the robot, with their labels.
    disabled : sequence of (str, str)
        Pairs of links that are not checked against each other.

    Raises
    ------
    InputError
        An obstacle moves in its frame or is unbounded, or its frame is unknown.
    """
    links, pairs = list(spheres.links), list(map(tuple, spheres.link_pairs.tolist()))
    for obstacle, label in carried:
        frame = robot.model.frames[robot.frame(str(obstacle.frame))]
        centres, radii = _enclosed(obstacle, label)
        position, rotation = obstacle.pose()
        local = centres @ rotation.T + position
        placed = local @ frame.placement.rotation.T + frame.placement.translation
        name = label if label not in links else f"{label} on {obstacle.frame}"
        joint = int(frame.parentJoint)
        # An obstacle may touch the links of its body, and the links that these may touch.
        beside = {links[i] for i in set(spheres.link[spheres.joint == joint].tolist())}
        near = candidate_pairs(robot, spheres.links, disabled)
        allowed = [link for link in spheres.links if link not in beside and _is_apart(link, beside, near)]
        pairs += [(links.index(link), len(links)) for link in allowed]
        links.append(name)
        spheres = replace(
            spheres,
            links=tuple(links),
            link=np.append(spheres.link, np.full(len(radii), len(links) - 1)),
            joint=np.append(spheres.joint, np.full(len(radii), joint)),
            centre=np.concatenate([spheres.centre, placed]),
            radius=np.append(spheres.radius, radii),
        )
    numbers = np.array(pairs, dtype=int).reshape(-1, 2)
    every = replace(spheres, link_pairs=numbers)
    return replace(every, link_pairs=numbers[~always_touching(robot, every)])


def _is_apart(link: str, beside: set[str], near: Sequence[tuple[str, str]]) -> bool:
    """Whether a link is checked against all links of the body that carries an obstacle."""
    return all((link, other) in near or (other, link) in near for other in beside)


def _enclosed(obstacle: Obstacle, label: str) -> tuple[Array, Array]:
    """Spheres of an obstacle that the robot carries."""
    if obstacle.moves:
        raise InputError(f"{label}: an obstacle on a frame moves with it; give its pose in the frame as numbers.")
    match obstacle:
        case Sphere():
            return np.zeros((1, 3)), np.array([obstacle.radius])
        case Capsule():
            return capsule_spheres(obstacle.radius, 0.5 * obstacle.length)[:2]
        case Box():
            fit = fitted(box_triangles(np.array(obstacle.dimensions)))
        case Cylinder():
            fit = fitted(cylinder_triangles(obstacle.radius, 0.5 * obstacle.length))
        case ConvexMesh():
            fit = fitted(hull_triangles(obstacle.vertices))
        case _:
            raise InputError(f"{label}: a {obstacle.kind} is unbounded and cannot be on a frame; give a box.")
    return fit.centres, fit.radii
