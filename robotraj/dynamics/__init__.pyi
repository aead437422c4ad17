"""Dynamics as semi-explicit DAEs: rigid bodies with contacts, ground and design parameters, and systems of one's own.

Start with ``dae.py``. The room may import ``robot`` and what lies below.
"""

from . import contacts, design, obstacles, terrain
from .dae import Dynamics, TimeOrders
from .point import Point, RobotPoint
from .rigid_body import RigidBody
from .rigid_body_forms import ForwardDynamics, InverseDynamics
from .system import System, SystemDynamics
from .variable import Named, Variable

__all__ = [
    "contacts",
    "design",
    "obstacles",
    "terrain",
    "Dynamics",
    "ForwardDynamics",
    "InverseDynamics",
    "Named",
    "Point",
    "RigidBody",
    "RobotPoint",
    "System",
    "SystemDynamics",
    "TimeOrders",
    "Variable",
]
