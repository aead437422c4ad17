"""A robot from its URDF: loading, limits, charts of its configuration space, and the robots known by name.

Start with ``robot.py``. The room may import ``_util``.
"""

from . import collision
from .carried_body import CarriedBody, carrying
from .join import join
from .known_robots.catalogue import catalogue
from .known_robots.makers import maker_limits
from .limits import Limits
from .load import load
from .mobile import on_rail, on_wheels
from .robot import Robot

__all__ = [
    "CarriedBody",
    "Limits",
    "Robot",
    "carrying",
    "catalogue",
    "collision",
    "join",
    "load",
    "maker_limits",
    "on_rail",
    "on_wheels",
]
