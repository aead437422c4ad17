"""How high a foot must be: a height that depends on how far it has come, or on anything else of a point."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from robotraj._util.errors import InputError, called
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.problem.constraints.path import flat
from robotraj.problem.scalars import PointExpression, Scalar

if TYPE_CHECKING:
    from robotraj.dynamics.point import RobotPoint

Coordinate: TypeAlias = "float | str | Callable[[RobotPoint], Scalar]"
"""A number [m], the name of a parameter, or a function of the point."""
Place: TypeAlias = "Coordinate | Sequence[Coordinate]"
"""World x, or (x, y)."""


class RequiredHeight(OneLine, ABC):
    """A clearance [m] that changes along the motion. A new profile is one new class."""

    @abstractmethod
    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Heights [m] that a place at ``position`` (3) [m] must all reach, by the names of their rows."""


@dataclass(frozen=True)
class SwingApex(RequiredHeight):
    """The parabola of a swing foot over its way: h = 4 apex s (1 - s), and never below the ground.

    s = (p - start) . (end - start) / |end - start|^2 is the foot's horizontal progress from one foothold to the
    next, 0 to 1. Before and beyond them the parabola is negative and imposes nothing; that the foot stays above the
    ground there is a separate row, so that every row is smooth.

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
        An apex that is not positive, footholds of different sizes or at one place; when bound, an unknown parameter.
    """

    apex: float
    start: Place
    end: Place

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
                f"rt.constraints.SwingApex starts and ends at {self.start!r}: there is no progress to measure."
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
    """A height [m] that a user's function of the point gives; several of them must all be reached."""

    function: PointExpression

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Evaluate the function."""
        values = flat(called("height function of the ground clearance", self.function, point))
        names = ["ground clearance"] if len(values) == 1 else [f"ground clearance[{i}]" for i in range(len(values))]
        return dict(zip(names, values, strict=True))


HeightLike: TypeAlias = "RequiredHeight | float | PointExpression"
"""A height [m], a profile of it, or a function of the point."""


def required_height(value: HeightLike, who: str) -> RequiredHeight | float:
    """Accept metres, a RequiredHeight or a function of the point.

    Raises
    ------
    InputError
        It is none of these, or not finite.
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
            f"{who}: the height is {value}; give metres, rt.constraints.SwingApex(...) or a function of the point."
        )
    return metres


def _entries(place: Place, name: str) -> tuple[Coordinate, ...]:
    """One or two entries of a foothold."""
    entries = tuple(place) if isinstance(place, Sequence | np.ndarray) and not isinstance(place, str) else (place,)
    numbers = [v for v in entries if not isinstance(v, str) and not callable(v)]
    finite = all(isinstance(v, int | float | np.number) and np.isfinite(v) for v in numbers)
    if len(entries) not in (1, 2) or not finite:
        raise InputError(f"rt.constraints.SwingApex: {name} is {place!r}; give a foothold as x or (x, y) [m].")
    return entries


def _read(value: Coordinate, point: RobotPoint) -> Scalar:
    if isinstance(value, str):
        return point.p[value]
    return called("foothold of rt.constraints.SwingApex", value, point) if callable(value) else value
