"""Dynamics as semi-explicit DAEs: user systems and rigid bodies."""

from . import contacts, design, terrain
from .dae import Dynamics, TimeOrders
from .point import Point, RobotPoint
from .rigid_body import ForwardDynamics, InverseDynamics, RigidBody
from .system import System, SystemDynamics
from .variable import Named, Variable

__all__ = [
    "contacts",
    "design",
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
