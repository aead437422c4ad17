"""Required heights of a foot as functions of a point, such as a parabola over its progress between footholds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError, called
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.path import flat
from robotraj.problem.scalars import PointExpression, Scalar

Coordinate: TypeAlias = "float | str | Callable[[RobotPoint], Scalar]"
"""A number [m], the name of a parameter, or a function of the point."""
Coordinates: TypeAlias = "Coordinate | Sequence[Coordinate]"
"""World x, or (x, y)."""


class RequiredHeight(OneLine, ABC):
    """A clearance [m] that changes along the motion. A new profile is one new class."""

    @abstractmethod
    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Lower bounds [m] on the height of a place at ``position`` (3) [m], by the names of their rows."""


@dataclass(frozen=True)
class SwingApex(RequiredHeight):
    """A parabola over the progress of a swing foot, h >= 4 apex s (1 - s), and h >= 0.

    s = (p - start) . (end - start) / |end - start|^2 is the foot's horizontal progress from one foothold to the
    next, 0 to 1. Before and beyond them the parabola is negative, and only h >= 0 matters. The two bounds are separate
    rows, so that every row is smooth.

    Parameters
    ----------
    apex : float
        Height [m] halfway.
    start, end : number or pair
        Footholds: world x, or (x, y) [m]. Each entry is a number, the name of a parameter of the phase (the foothold
        ``"left.x"`` of a contact ``"left"``), or a function of the point.

    Raises
    ------
    InputError
        The apex is not positive, or the footholds have different sizes or coincide. On binding: a parameter is unknown.
    """

    apex: float
    start: Coordinates
    end: Coordinates

    def __post_init__(self) -> None:
        if not (np.isfinite(self.apex) and self.apex > 0):
            raise InputError(f"rt.constraints.SwingApex has the apex {self.apex!r}; give a positive height [m].")
        start, end = (_entries(getattr(self, name), name) for name in ("start", "end"))
        if len(start) != len(end):
            raise InputError(
                f"rt.constraints.SwingApex goes from {self.start!r} to {self.end!r}; give x, or (x, y), for both."
            )
        if start == end:
            raise InputError(
                f"rt.constraints.SwingApex starts and ends at {self.start!r}; give two different footholds."
            )

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Ground and parabola [m]."""
        start = [_read(value, point) for value in _entries(self.start, "start")]
        way = [_read(value, point) - begin for value, begin in zip(_entries(self.end, "end"), start, strict=True)]
        gone = sum((position[i] - begin) * step for i, (begin, step) in enumerate(zip(start, way, strict=True)))
        progress = gone / sum(step * step for step in way)
        return {"ground clearance": 0.0, "swing apex": 4.0 * self.apex * progress * (1.0 - progress)}


@dataclass(frozen=True)
class HeightOf(RequiredHeight):
    """A height [m], or several, from a user's function of the point."""

    function: PointExpression

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Evaluate the function."""
        values = flat(called("height function of the ground clearance", self.function, point))
        names = ["ground clearance"] if len(values) == 1 else [f"ground clearance[{i}]" for i in range(len(values))]
        return dict(zip(names, values, strict=True))


HeightLike: TypeAlias = "RequiredHeight | float | PointExpression"
"""A height [m], a profile of it, or a function of the point."""


def required_height(value: HeightLike, what: str) -> RequiredHeight | float:
    """Accept metres, a RequiredHeight or a function of the point.

    Raises
    ------
    InputError
        The value is none of these, or not finite.
    """
    if isinstance(value, RequiredHeight):
        return value
    if callable(value):
        return HeightOf(value)
    try:
        metres = float(value)
    except (TypeError, ValueError):
        metres = np.nan
    if not np.isfinite(metres):
        raise InputError(
            f"{what}: the height is {value}; give metres, rt.constraints.SwingApex(...) or a function of the point."
        )
    return metres


def _entries(place: Coordinates, name: str) -> tuple[Coordinate, ...]:
    """One or two entries of a foothold."""
    entries = tuple(place) if isinstance(place, Sequence | np.ndarray) and not isinstance(place, str) else (place,)
    numbers = [v for v in entries if not isinstance(v, str) and not callable(v)]
    finite = all(is_finite(v) for v in numbers)
    if len(entries) not in (1, 2) or not finite:
        raise InputError(f"rt.constraints.SwingApex: {name} is {place!r}; give a foothold as x or (x, y) [m].")
    return entries


def _read(value: Coordinate, point: RobotPoint) -> Scalar:
    if isinstance(value, str):
        return point.p[value]
    return called("foothold of rt.constraints.SwingApex", value, point) if callable(value) else value
