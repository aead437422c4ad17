"""An inclined plane."""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground


@dataclass(frozen=True)
class Slope(Ground):
    """A plane, h = level + slope_x x + slope_y y, with slopes as rise over run.

    Raises
    ------
    InputError
        A value is not finite.
    """

    slope_x: float = 0.0
    slope_y: float = 0.0
    level: float = 0.0
    even = True

    def __post_init__(self) -> None:
        if not np.isfinite([self.slope_x, self.slope_y, self.level]).all():
            raise InputError(f"{self!r}: give finite slopes as rise over run and a finite level in metres.")

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        return self.level + self.slope_x * x + self.slope_y * y
