"""Parts of a phase that are simulated in one go, and what a simulation returns."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass

INSIDE = 1e-9
"""Distance from its ends, relative to its length, at which a span is sampled: controls may jump at knots."""


class Stopped(Exception):
    """The integration cannot continue.

    Attributes
    ----------
    time : float
        [s].
    reason : str
    """

    def __init__(self, time: float, reason: str) -> None:
        super().__init__(reason)
        self.time = time
        self.reason = reason


@dataclass(frozen=True)
class Motion:
    """A simulated motion.

    Attributes
    ----------
    times : ndarray (m,)
        Sample times [s], every knot among them.
    states : ndarray (m, n)
    intervals : ndarray (m,)
        Interval of each sample.
    failure : str or None
        Why the integration stopped early; None if it reached the end.
    stopped : float
        Time reached [s].
    stiff : float or None
        Time [s] from which on an implicit method integrated; None if an explicit one integrated everything.
    """

    times: Array
    states: Array
    intervals: NDArray[np.int_]
    failure: str | None
    stopped: float
    stiff: float | None = None


class Driven(Protocol):
    """A motion under the planned controls; see ``Plant``."""

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Return the planned states (m, n) at times (m,)."""
        ...

    def given(self, times: Array) -> Array:
        """Return the planned controls at times (m,), one row each."""
        ...

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Return the rate (n,) of a state."""
        ...

    def jacobian(self, t: float, x: Array, given: Array) -> Array:
        """Return the derivative (n, n) of ``rate`` with respect to x."""
        ...


class Span(NamedTuple):
    """A part of one interval of a phase, from begin to end [s]."""

    begin: float
    end: float
    interval: int

    @property
    def length(self) -> float:
        """[s]."""
        return self.end - self.begin

    def inside(self, times: Array) -> Array:
        """Move times to the inside of the span where they are its ends."""
        margin = INSIDE * self.length
        return np.clip(times, self.begin + margin, self.end - margin)


def spans_of(knots: Array) -> list[Span]:
    """Return the intervals of a phase whose length is not zero."""
    pairs = zip(knots[:-1], knots[1:], strict=True)
    return [Span(float(begin), float(end), k) for k, (begin, end) in enumerate(pairs) if end > begin]
