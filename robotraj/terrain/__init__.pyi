"""The ground: height fields that contacts, clearance and replays share."""

from robotraj.terrain.base import Ground
from robotraj.terrain.flat import Flat
from robotraj.terrain.function import HeightFunction, as_ground
from robotraj.terrain.height_map import HeightMap
from robotraj.terrain.slope import Slope
from robotraj.terrain.steps import Steps

__all__ = [
    "Flat",
    "Ground",
    "HeightFunction",
    "HeightMap",
    "Slope",
    "Steps",
    "as_ground",
]
