"""The collision shapes of a robot and the spheres around them, as translucent layers of the page."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from trimesh import creation

from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.replay_page.scene.part import Color, weld
from robotraj.replay_page.scene.shapes import shape_part
from robotraj.replay_page.scene.visuals import Visual
from robotraj.robot.collision.robot_spheres import robot_spheres
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import GaitCycles

COLOR: Color = (0.84, 0.37, 0.0, 0.35)
SPHERES_COLOR: Color = (0.35, 0.20, 0.75, 0.22)
MOST = 1500
"""Largest number of triangles of a drawn collision mesh; vertices of a larger one are merged in cells."""


def collision_shapes(geometry: pin.GeometryModel | None) -> tuple[Visual, ...]:
    """Return the shapes that Pinocchio's collision model has, each fixed to its joint; unknown kinds are left out."""
    found = []
    for thing in geometry.geometryObjects if geometry is not None else ():
        placement = np.array(thing.placement.homogeneous)
        try:
            part = shape_part(thing.geometry, MOST)
        except LookupError:
            continue
        if part is not None:
            found.append(Visual(int(thing.parentJoint), str(thing.name), placement, ((part, COLOR),)))
    return tuple(found)


def collision_spheres(robot: Robot, cycles: GaitCycles) -> tuple[Visual, ...]:
    """Return a visual of the spheres of each link; none where no phase imposes ``CollisionFree``."""
    every = [constraint for result in cycles.phases for constraint in result.phase.constraints]
    if not any(isinstance(constraint, CollisionFree) for constraint in every):
        return ()
    spheres, ball = robot_spheres(robot), creation.icosphere(subdivisions=2)
    found = []
    for number, link in enumerate(spheres.links):
        own = np.flatnonzero(spheres.link == number)
        vertices = np.concatenate([spheres.centre[i] + spheres.radius[i] * ball.vertices for i in own])
        faces = np.concatenate([k * len(ball.vertices) + ball.faces for k in range(len(own))])
        part = weld(vertices, faces)
        if part is not None:
            found.append(Visual(int(spheres.joint[own[0]]), link, np.eye(4), ((part, SPHERES_COLOR),)))
    return tuple(found)
