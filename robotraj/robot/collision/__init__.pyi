"""The robot's collision geometry: spheres that enclose its shapes, and the pairs of links that may touch.

Start with ``robot_spheres.py``.
"""

from .link_pairs import read_srdf
from .placements import placements
from .robot_spheres import RobotSpheres, robot_spheres

__all__ = [
    "RobotSpheres",
    "placements",
    "read_srdf",
    "robot_spheres",
]
