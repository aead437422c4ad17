"""A row and its values along a plan."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.dynamics.row import Row
from robotraj.solution.violation import Violation, violated

SOLVER_NOISE = 1e-6
"""Largest violation, relative to the size or limit of the row, that is a solver's tolerance and is not listed."""


@dataclass
class Watch:
    """A row and its values at sampled times.

    Attributes
    ----------
    row : Row
    size : float or None
        Violation that counts as 1, in the unit of the row; None for ``Row.size``.
    """

    row: Row
    size: float | None = None
    times: list[Array] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)

    def see(self, times: Array, values: Array) -> None:
        """Add values (m,) at times (m,)."""
        self.times.append(times)
        self.values.append(values)

    @property
    def nearest(self) -> float:
        """Time [s] at which the row comes nearest to one of its bounds, or violates it most."""
        times, excess = np.concatenate(self.times), self._excess
        return float(times[np.argmax(excess)])

    @property
    def peak(self) -> float:
        """Largest absolute value, 0 without any."""
        return max((float(np.abs(values).max(initial=0.0)) for values in self.values), default=0.0)

    @property
    def is_violated(self) -> bool:
        """Whether any value is beyond a bound."""
        return bool(self.values) and float(self._excess.max()) > 0.0

    @property
    def hidden_peak(self) -> tuple[float, float] | None:
        """Times between which the row may violate its bounds although no value does, None if it cannot.

        A parabola through three neighbouring values exceeds the middle one by at most half of its bend.
        """
        times, first = np.unique(np.concatenate(self.times), return_index=True)
        if len(times) < 3:
            return None
        excess = self._excess[first]
        i = int(np.clip(np.argmax(excess), 1, len(times) - 2))
        bend = abs(excess[i - 1] - 2.0 * excess[i] + excess[i + 1])
        return (float(times[i - 1]), float(times[i + 1])) if excess.max() <= 0.0 < excess[i] + bend else None

    @property
    def _excess(self) -> Array:
        """Distance (m,) of each value beyond its bounds, infinite where it is not a number."""
        values = np.concatenate(self.values)
        excess = np.maximum(values - float(self.row.upper), float(self.row.lower) - values)
        return np.asarray(np.nan_to_num(excess, nan=np.inf))

    def worst(self, phase: str) -> Violation | None:
        """Return the largest violation, None if the row holds to a solver's tolerance."""
        row, i = self.row, int(np.argmax(self._excess))
        value, time = float(np.concatenate(self.values)[i]), float(np.concatenate(self.times)[i])
        amount, limit, side = violated(value, float(row.lower), float(row.upper))
        size = float(row.size) if self.size is None else self.size
        if amount <= SOLVER_NOISE * max(min(1.0, size), abs(limit)):
            return None
        found = Violation(phase, row.name, row.joint, time, amount, row.unit, limit, side, size)
        return found.measured(row.measure)
