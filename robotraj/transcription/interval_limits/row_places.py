"""Places of rows on single intervals: rows that are added there, and limits that are lowered there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from robotraj._util.values import dataclass


@dataclass(frozen=True)
class AddedRow:
    """One row of a phase, imposed at tau in [0, 1] of an interval.

    Attributes
    ----------
    phase, interval : int
        Indices.
    row : int
        Number of the row in the phase's table.
    tau : float
    """

    phase: int
    interval: int
    row: int
    tau: float

    @property
    def place(self) -> tuple[int, int, float]:
        """Phase, interval and tau."""
        return self.phase, self.interval, self.tau


class LimitedInterval(NamedTuple):
    """A row of a phase on one interval; indices as in ``AddedRow``."""

    phase: int
    interval: int
    row: int


Margins = Mapping[LimitedInterval, float]
"""Amounts by which the limits of rows are lowered, in their SI unit."""
