"""Dynamics as semi-explicit DAEs: user systems and rigid bodies."""

from robotraj.dynamics.dae import Dynamics, TimeOrders
from robotraj.dynamics.point import Point, RobotPoint
from robotraj.dynamics.rigid_body import ForwardDynamics, InverseDynamics, RigidBody
from robotraj.dynamics.system import System, SystemDynamics
from robotraj.dynamics.variable import Named, Variable

__all__ = [
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
