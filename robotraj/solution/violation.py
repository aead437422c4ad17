"""A bound that a motion violates, as the planner and the reports of the witness state it."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.row import Measure

Side = Literal["over", "under", "off"]
"""``"over"`` an upper bound, ``"under"`` a lower bound, ``"off"`` the required value of an equality."""


@dataclass(frozen=True)
class Violation(OneLine):
    """A violated bound, at the time of its largest violation.

    Attributes
    ----------
    phase : str
        Name of the phase.
    name : str
        The row: ``"effort limit"``, ``"ground clearance"``, ``"defect"`` ...
    joint : str or None
        Its joint, frame, state or parameter.
    time : float
        [s].
    amount : float
        Distance of the value from the bound [unit]; infinite where the value is not a number.
    unit : str
    limit : float
        The violated bound [unit].
    side : Side
    size : float
        Amount [unit] that counts as a relative violation of 1. The planner takes the scale of the row in the NLP, and
        ``Row.size_in`` of the motion between the points, as the witness does.
    """

    phase: str
    name: str
    joint: str | None
    time: float
    amount: float
    unit: str
    limit: float
    side: Side
    size: float = 1.0

    @property
    def relative(self) -> float:
        """``amount`` / ``size``: violations are ranked by it and compared with tolerances; infinite without a size."""
        return self.amount / self.size if self.size else np.inf

    @property
    def label(self) -> str:
        """Name and joint: ``"effort limit, elbow"``."""
        return f"{self.name}, {self.joint}" if self.joint else self.name

    def measured(self, measure: Measure | None) -> Violation:
        """Return the violation of a row's measure, relatively as large; the violation itself without a measure."""
        if measure is None:
            return self
        limit = measure.of(self.limit)
        amount = abs(measure.of(self.limit + (-self.amount if self.side == "under" else self.amount)) - limit)
        size = amount / self.relative if np.isfinite(self.amount) else self.size
        return replace(self, amount=amount, unit=measure.unit, limit=limit, size=size)

    def __str__(self) -> str:
        amount, limit = (f"{value:.4g} {self.unit}".rstrip() for value in (self.amount, self.limit))
        target = f"the required {limit}" if self.side == "off" else f"the limit of {limit}"
        return f"{self.label}, t = {self.time:.4g} s: {amount} {self.side} {target}"


def violated(value: float, lower: float, upper: float) -> tuple[float, float, Side]:
    """Return the distance of a value from its bounds, the bound and its side; the distance is negative inside."""
    below, above = lower - value, value - upper
    amount = max(below, above) if np.isfinite(value) else np.inf
    upwards = above >= below if np.isfinite(value) else np.isfinite(upper)
    side: Side = "off" if lower == upper else "over" if upwards else "under"
    return float(amount), float(upper if upwards else lower), side
