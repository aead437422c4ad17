"""One scalar row: a value between two bounds. Contacts, constraints and links write their conditions as rows."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Scalar

LEAST_SIZE = 1e-2
"""Least size of a row with one bound, in its unit: smaller bounds, such as 1e-6 kg, mostly stand for 0."""
FEW = 3.0
"""Largest size of a row relative to what a motion changes it by: ranges and units may be far larger than the motion."""


class Measure(ABC):
    """A quantity that a row bounds through a smooth function of it; reports state the quantity.

    Attributes
    ----------
    unit : str
        SI unit of the quantity.
    """

    unit: str

    @abstractmethod
    def of(self, value: float) -> float:
        """Return the quantity [unit] for a value of the row; infinite values stay."""

    @abstractmethod
    def value_of(self, quantity: float) -> float:
        """Return the value of the row for a quantity [unit]."""


@dataclass(frozen=True)
class Magnitude(Measure):
    """The length of a vector w, whose row is w'w / limit^2."""

    limit: float
    unit: str

    def of(self, value: float) -> float:
        """Return limit sqrt(value)."""
        return self.limit * float(np.sqrt(max(value, 0.0))) if value > -np.inf else value

    def value_of(self, quantity: float) -> float:
        """Return (quantity / limit)^2."""
        return (quantity / self.limit) ** 2


@dataclass(frozen=True)
class Angle(Measure):
    """An angle a, whose row is sqrt((1 + x) / 2) with x = (1 - cos(a)) / (1 - cos(limit)) and 0 < limit < pi.

    The row is 1 at the limit. It is smooth at a = 0 and almost linear in a beyond the limit, so that a linear model
    leads back from far outside. x itself is quadratic: beside a narrow limit, its linear model halves the angle.
    """

    limit: float
    unit: str = "rad"

    def of(self, value: float) -> float:
        """Return the angle of a row's value."""
        if not np.isfinite(value):
            return value
        return float(np.arccos(np.clip(1.0 - (2.0 * value**2 - 1.0) * (1.0 - np.cos(self.limit)), -1.0, 1.0)))

    def value_of(self, quantity: float) -> float:
        """Return the row's value at an angle."""
        return float(self.row(np.cos(quantity)))

    def row(self, cosine: Scalar) -> Scalar:
        """Return the row's value at cos(a), symbolic or numeric."""
        return (0.5 + (0.5 / (1.0 - np.cos(self.limit))) * (1.0 - cosine)) ** 0.5


@dataclass(frozen=True)
class Row(OneLine):
    """One scalar row: lower <= value <= upper.

    Attributes
    ----------
    name : str
        What is bounded, for example ``"effort limit"``.
    unit : str
        SI unit of the value and of both bounds.
    lower, upper : float
        Bounds, infinite where open.
    joint : str or None
        Name of the joint, frame, contact or variable that the row bounds.
    variable : str or None
        Name of the DAE's variable, if the value is a single variable. The row then becomes a bound of the NLP. With
        ``Where.RATE`` it bounds the variable's time derivative. ``Phase.rows`` lists the rows of a phase.
    measure : Measure or None
        The quantity that reports state in place of the value, if the value is a function of it.
    selects_root : bool
        Whether the row only excludes spurious roots of other rows of its constraint.
    """

    name: str
    unit: str
    lower: float
    upper: float
    joint: str | None = None
    variable: str | None = None
    measure: Measure | None = None
    selects_root: bool = False

    @property
    def label(self) -> str:
        """Name and joint, as reports show them."""
        return f"{self.name}, {self.joint}" if self.joint else self.name

    @property
    def is_equality(self) -> bool:
        """Whether both bounds are the same number."""
        return self.lower == self.upper

    @property
    def greatest_bound(self) -> float:
        """Largest absolute value of the finite bounds, in ``unit``; 0 without any."""
        return max((abs(bound) for bound in (self.lower, self.upper) if np.isfinite(bound)), default=0.0)

    @property
    def size(self) -> float:
        """Violation that counts as 1 by the bounds alone, in ``unit``; a motion may lower it (``size_in``).

        It is half the range of two bounds, and the absolute value of a single one, at least 0.01. The size of the
        value is unknown with a bound of 0, which counts as 1. The size of an equality is max(1, abs(bound)).
        """
        if self.is_equality:
            return max(1.0, self.greatest_bound)
        width = self.upper - self.lower
        return 0.5 * width if width < np.inf else max(LEAST_SIZE, self.greatest_bound or 1.0)

    def size_in(self, change: float) -> float:
        """Return the violation that counts as 1 in a motion that changes the value by ``change``, in ``unit``.

        It is ``size``, and at most ``FEW`` times that change, unless this is unknown: 0 or not finite.
        """
        return min(self.size, FEW * change) if 0.0 < change < np.inf else self.size

    @property
    def shown_unit(self) -> str:
        """Unit in which reports state values and bounds of the row."""
        return self.unit if self.measure is None else self.measure.unit

    def shown(self, value: float) -> float:
        """Return a value or a bound of the row as reports state it [shown_unit]."""
        return value if self.measure is None else self.measure.of(value)
