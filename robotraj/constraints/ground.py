"""The ground: a height z = h(x, y) over the world's horizontal plane."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from robotraj.errors import InputError


class Ground(ABC):
    """A height field. A new ground is one class with ``height``."""

    @abstractmethod
    def height(self, x: Any, y: Any) -> Any:
        """Height of the ground [m] at world position (x, y) [m]; symbolic where x and y are."""


@dataclass(frozen=True)
class Flat(Ground):
    """Level ground, h = level [m]."""

    level: float = 0.0

    def height(self, x: Any, y: Any) -> Any:
        """Height of the ground [m]."""
        return self.level + 0.0 * x


@dataclass(frozen=True)
class Slope(Ground):
    """A plane, h = level + slope_x x + slope_y y, with slopes as rise over run."""

    slope_x: float = 0.0
    slope_y: float = 0.0
    level: float = 0.0

    def height(self, x: Any, y: Any) -> Any:
        """Height of the ground [m]."""
        return self.level + self.slope_x * x + self.slope_y * y


@dataclass(frozen=True)
class HeightFunction(Ground):
    """Any smooth height function h(x, y) written with CasADi functions."""

    function: Callable[[Any, Any], Any]

    def height(self, x: Any, y: Any) -> Any:
        """Height of the ground [m]."""
        return self.function(x, y)


def as_ground(value: Any) -> Ground:
    """Accept a Ground or a plain function of (x, y)."""
    if isinstance(value, Ground):
        return value
    if callable(value):
        return HeightFunction(value)
    raise InputError(f"ground must be rt.Flat, rt.Slope or a function of (x, y) [m]; got {value!r}.")
