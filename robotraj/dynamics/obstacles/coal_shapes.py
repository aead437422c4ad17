"""Obstacles as coal's exact shapes."""

from __future__ import annotations

import coal
import numpy as np

from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.convex_mesh import ConvexMesh
from robotraj.dynamics.obstacles.shapes import Box, Capsule, Cylinder, HalfSpace, Sphere


def coal_shape(obstacle: Obstacle) -> coal.CollisionGeometry:
    """Return the shape of an obstacle in its own axes."""
    match obstacle:
        case Box():
            return coal.Box(*obstacle.sides)
        case Sphere():
            return coal.Sphere(obstacle.radius)
        case Cylinder():
            return coal.Cylinder(obstacle.radius, obstacle.length)
        case Capsule():
            return coal.Capsule(obstacle.radius, obstacle.length)
        case HalfSpace():
            return coal.Halfspace(np.array(obstacle.normal), float(obstacle.offset))
        case ConvexMesh():
            points = coal.StdVec_Vec3s()
            points.extend(list(np.asarray(obstacle.vertices)))
            return coal.Convex.convexHull(points, False, "")
    raise TypeError(f"{type(obstacle).__name__} is no obstacle with a shape of coal.")
