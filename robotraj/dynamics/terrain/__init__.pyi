"""The ground: height fields that contacts, clearance and replays share."""

from .base import Ground
from .flat import Flat
from .function import HeightFunction, as_ground
from .height_map import HeightMap
from .lowest import Lowest
from .plane import Plane
from .slope import Slope
from .steps import Steps

__all__ = [
    "Flat",
    "Ground",
    "HeightFunction",
    "HeightMap",
    "Lowest",
    "Plane",
    "Slope",
    "Steps",
    "as_ground",
]
