"""Contacts: what holds the robot, with which forces. Values, bound to a robot by ``bind``."""

from robotraj.contacts.base import BoundContact, Contact, LimitRow
from robotraj.contacts.cones import FrictionCone, Linearised, SecondOrder
from robotraj.contacts.flat_foot import FlatFoot
from robotraj.contacts.implicit import ImplicitContact
from robotraj.contacts.line_contact import LineContact
from robotraj.contacts.loop_closure import LoopClosure
from robotraj.contacts.point_contact import PointContact
from robotraj.contacts.soles import FourCorners, PressureAndTorsion, Sole

__all__ = [
    "BoundContact",
    "Contact",
    "FlatFoot",
    "FourCorners",
    "FrictionCone",
    "ImplicitContact",
    "LimitRow",
    "LineContact",
    "Linearised",
    "LoopClosure",
    "PointContact",
    "PressureAndTorsion",
    "SecondOrder",
    "Sole",
]
