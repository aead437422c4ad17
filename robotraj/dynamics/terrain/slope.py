"""An inclined plane."""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground

STEEP = 2.0
"""Rise over run above which a slope is doubted: 63 degrees."""


@dataclass(frozen=True)
class Slope(Ground):
    """A plane, h = level + slope_x x + slope_y y, with slopes as rise over run.

    Raises
    ------
    InputError
        A value is not finite.

    Warns
    -----
    UserWarning
        A slope is steeper than ``STEEP``, and so plausible in degrees or percent only.
    """

    slope_x: float = 0.0
    slope_y: float = 0.0
    level: float = 0.0
    even = True

    def __post_init__(self) -> None:
        if not np.isfinite([self.slope_x, self.slope_y, self.level]).all():
            raise InputError(f"{self!r}: give finite slopes as rise over run and a finite level in metres.")
        steepest = max(abs(self.slope_x), abs(self.slope_y))
        if steepest > STEEP:
            warn(
                f"{self!r} rises by {steepest:g} m in 1 m. A slope is rise over run: {steepest:g} degrees are "
                f"{np.tan(np.radians(min(steepest, 89.0))):.4g}, {steepest:g} percent {steepest / 100:g}."
            )

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        return self.level + self.slope_x * x + self.slope_y * y
