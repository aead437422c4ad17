"""Height of a swing foot between two footholds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.dynamics.variable import Scalar
from robotraj.problem.clearance.swinging_feet import TOUCH
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.heights import RequiredHeight


@dataclass(frozen=True)
class FootholdArc(RequiredHeight):
    """Height [m] of a swing foot on the line between two footholds: h = 4 (apex + d) s (1 - s) - d, d = 0.1 mm.

    Attributes
    ----------
    apex : float
        Height halfway [m].
    start, end : tuple of float
        Horizontal coordinates of the footholds [m].
    """

    apex: float
    start: tuple[float, ...]
    end: tuple[float, ...]

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Return the least heights at ``position``."""
        line = [b - a for a, b in zip(self.start, self.end, strict=True)]
        length = sum(entry**2 for entry in line)
        s = sum((position[i] - a) * d for i, (a, d) in enumerate(zip(self.start, line, strict=True))) / length
        return {"ground clearance": -TOUCH, "swing apex": 4.0 * (self.apex + TOUCH) * s * (1.0 - s) - TOUCH}


@dataclass(frozen=True)
class TimedArc(RequiredHeight):
    """Height [m] of a swing foot over time: h = 16 (apex + d) s^2 (1 - s)^2 - d.

    s is the fraction of the swing, and d = 0.1 mm. It is for steps shorter than their apex, over which ``FootholdArc``
    would be too steep.

    Attributes
    ----------
    apex : float
        Height halfway [m].
    start, end : float
        Times of liftoff and touchdown [s].
    """

    apex: float
    start: float
    end: float

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Return the least height at the time of the point."""
        s = (point.t - self.start) / (self.end - self.start)
        return {"swing apex": 16.0 * (self.apex + TOUCH) * s**2 * (1.0 - s) ** 2 - TOUCH}


def step_clearances(
    contact: BoundContact,
    before: Mapping[str, float],
    after: Mapping[str, float],
    air: tuple[float, float],
    apex: float,
    ground: Ground | GroundFunction,
) -> list[GroundClearance]:
    """Return the clearance of a foot that swings between footholds, and of the corners of its sole.

    Parameters
    ----------
    contact : BoundContact
        Contact of the foot.
    before, after : mapping of str to float
        Anchors of both footholds by name [m, rad].
    air : (float, float)
        Times of liftoff and touchdown [s].
    apex : float
        Height of the foot halfway [m]. A step shorter than it gets a ``TimedArc``, a longer one a ``FootholdArc``.
    ground : Ground or callable
    """
    names = [f"{contact.name}.{axis}" for axis in "xy" if f"{contact.name}.{axis}" in before]
    start, end = (tuple(side[name] for name in names) for side in (before, after))
    spot = contact.touching.plainly
    short = np.linalg.norm(np.subtract(end, start)) < apex
    arc = TimedArc(apex, *air) if short else FootholdArc(apex, start, end)
    rows = [GroundClearance(spot, arc if apex > 0.0 else -TOUCH, ground)]
    outline = contact.outline()
    if outline == [contact.touching]:
        return rows
    return [*rows, GroundClearance([corner.plainly for corner in outline], -TOUCH, ground)]
