"""Contacts: what holds the robot, with which forces. Values, bound to a robot by ``bind``."""

from .base import BoundContact, Contact
from .cones import FrictionCone, Linearised, SecondOrder
from .edges.arc_foot import ArcFoot
from .edges.line_contact import LineContact
from .flat_foot import FlatFoot
from .implicit import ImplicitContact
from .loop_closure import LoopClosure
from .point_contact import PointContact
from .point_on_frame import Spot
from .soles import FourCorners, PressureAndTorsion, Sole

__all__ = [
    "ArcFoot",
    "BoundContact",
    "Contact",
    "FlatFoot",
    "FourCorners",
    "FrictionCone",
    "ImplicitContact",
    "LineContact",
    "Linearised",
    "LoopClosure",
    "PointContact",
    "PressureAndTorsion",
    "SecondOrder",
    "Sole",
    "Spot",
]
