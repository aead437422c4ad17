"""Level ground."""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground


@dataclass(frozen=True)
class Flat(Ground):
    """Level ground, h = level [m].

    Raises
    ------
    InputError
        The level is not finite.
    """

    level: float = 0.0
    even = True

    def __post_init__(self) -> None:
        if not np.isfinite(self.level):
            raise InputError(f"rt.terrain.Flat has the level {self.level}; give a finite height in metres.")

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        return self.level
