"""Obstacles: solid shapes in the world or on a frame of the robot, at rest or moving, for ``rt.CollisionFree``.

Start with ``base.py``.
"""

from .base import Obstacle
from .convex_mesh import ConvexMesh
from .primitives import Primitives, primitives_of
from .shapes import Box, Capsule, Cylinder, HalfSpace, Sphere

__all__ = [
    "Box",
    "Capsule",
    "ConvexMesh",
    "Cylinder",
    "HalfSpace",
    "Obstacle",
    "Primitives",
    "Sphere",
    "primitives_of",
]
