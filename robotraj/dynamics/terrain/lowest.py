"""The lowest of several grounds, above which a motion over all of them stays."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground


@dataclass(frozen=True)
class Lowest(Ground):
    """The lowest of several grounds at every place, h(x, y) = min_i h_i(x, y).

    A foot that climbs from a slope onto a box starts below the top of the box, and is above the lower of both.

    Parameters
    ----------
    grounds : sequence of Ground

    Raises
    ------
    InputError
        There is no ground, or one is not below the robot.
    """

    grounds: Sequence[Ground]

    def __post_init__(self) -> None:
        grounds = tuple(as_ground(each) for each in self.grounds)
        object.__setattr__(self, "grounds", grounds)
        if not grounds or not all(each.below for each in grounds):
            raise InputError("rt.terrain.Lowest takes grounds below the robot; give at least one, and no wall.")

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        return reduce(ca.fmin, [ca.SX(each.surface(x, y)) for each in self.grounds])

    def bends(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return the places of all grounds."""
        first, second = zip(*(each.bends() for each in self.grounds), strict=True)
        return sum(map(list, first), []), sum(map(list, second), [])
