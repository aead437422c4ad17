"""The seconds that a step of a control loop may take."""

from __future__ import annotations

import time

import numpy as np

FORGOTTEN = 0.9
"""Decrease, from step to step, of the time that is reserved for checking and returning the iterate."""


class Deadline:
    """Wall-clock seconds of a step, less those that earlier steps took after their solve; None for no end."""

    def __init__(self, seconds: float | None) -> None:
        self._seconds = np.inf if seconds is None else seconds
        self._returning = 0.0

    def left(self, began: float) -> float:
        """Return the seconds that are left for the solve of a step that began at a time of ``time.perf_counter``."""
        return self._seconds - self._returning - (time.perf_counter() - began)

    def returned(self, solved: float) -> float:
        """Return the time, and reserve what has passed since ``solved`` in the next steps."""
        ended = time.perf_counter()
        self._returning = max(ended - solved, FORGOTTEN * self._returning)
        return ended
