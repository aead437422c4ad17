"""Design: numbers of the robot itself (masses, lengths, loads, damping) as parameters of the plan."""

from .binding import Design, realised
from .damping import JointDamping
from .gear import GearRatio
from .length import LinkLength
from .mass import BodyMass
from .payload import Payload
from .quantity import Quantity

__all__ = [
    "BodyMass",
    "Design",
    "GearRatio",
    "JointDamping",
    "LinkLength",
    "Payload",
    "Quantity",
    "realised",
]
