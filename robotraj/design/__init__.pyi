"""Design: numbers of the robot itself (masses, lengths, loads, damping) as parameters of the plan."""

from robotraj.design.binding import Design, realised
from robotraj.design.damping import JointDamping
from robotraj.design.length import LinkLength
from robotraj.design.mass import BodyMass
from robotraj.design.payload import Payload
from robotraj.design.quantity import Quantity

__all__ = [
    "BodyMass",
    "Design",
    "JointDamping",
    "LinkLength",
    "Payload",
    "Quantity",
    "realised",
]
