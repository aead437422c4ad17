"""Contacts: what holds the robot, with which forces. Values, bound to a robot by ``bind``."""

from robotraj.contacts.base import BoundContact, Contact, LimitRow
from robotraj.contacts.cones import FrictionCone, Linearised, SecondOrder
from robotraj.contacts.point_contact import PointContact

__all__ = [
    "BoundContact",
    "Contact",
    "FrictionCone",
    "LimitRow",
    "Linearised",
    "PointContact",
    "SecondOrder",
]
