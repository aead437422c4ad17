"""A plane in any attitude: a wall, a ceiling, the side of a box."""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import PLANS, Ground

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Plane(Ground):
    """The plane outward . (p - point) = 0, a wall or ceiling that hands and feet push against.

    Its height is along the world axis nearest to its normal: along x for the wall ``Plane((1, 0, 0), (-1, 0, 0))``,
    one metre in front of the robot and facing it. A contact on it has the parameters ``<name>.y`` and ``<name>.z``.

    Parameters
    ----------
    point : sequence of 3 float
        A point of the plane [m].
    outward : sequence of 3 float
        The plane's normal towards the free side, of any length.

    Raises
    ------
    InputError
        A vector has not three finite numbers, or the normal has length zero.
    """

    point: Triple
    outward: Triple
    even = True

    def __post_init__(self) -> None:
        for name in ("point", "outward"):
            value = np.asarray(getattr(self, name), dtype=float)
            if value.shape != (3,) or not np.isfinite(value).all():
                raise InputError(f"rt.terrain.Plane: {name} is {getattr(self, name)!r}; give three finite numbers.")
            object.__setattr__(self, name, tuple(float(part) for part in value))
        size = float(np.linalg.norm(self.outward))
        if size == 0.0:
            raise InputError("rt.terrain.Plane: outward has length zero; give the normal towards the free side.")
        unit = np.array(self.outward) / size
        # Of two equal components the later axis counts, so that a slope of 45 degrees is a ground.
        axis = 2 - int(np.argmax(np.round(np.abs(unit[::-1]), 12)))
        object.__setattr__(self, "outward", tuple(float(part) for part in unit))
        object.__setattr__(self, "axis", axis)
        object.__setattr__(self, "side", float(np.sign(unit[axis])))

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Coordinate along ``axis`` [m] over the two axes of ``plan``."""
        first, second = PLANS[self.axis]
        n, p = self.outward, self.point
        return p[self.axis] - (n[first] * (x - p[first]) + n[second] * (y - p[second])) / n[self.axis]
