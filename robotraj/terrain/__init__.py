"""The ground: height fields that contacts, clearance and replays share."""

from robotraj.terrain.base import Ground
from robotraj.terrain.flat import Flat
from robotraj.terrain.function import HeightFunction, as_ground
from robotraj.terrain.slope import Slope

__all__ = ["Flat", "Ground", "HeightFunction", "Slope", "as_ground"]
