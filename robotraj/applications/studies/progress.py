"""Progress of a study on one line of the terminal: done, failed, rate, time left, slowest case."""

from __future__ import annotations

import sys
import time

EVERY = 0.5
"""Time between two lines [s]."""


class Progress:
    """Counts of a study.

    Parameters
    ----------
    total : int
        Number of cases to plan.
    show : bool, optional
        Whether to write the line; by default where the error output is a terminal.
    """

    def __init__(self, total: int, show: bool | None = None) -> None:
        self.total, self.done, self.failed, self.seconds = total, 0, 0, 0.0
        self.slowest: tuple[float, str] = 0.0, ""
        self._began = self._shown = time.monotonic()
        self._show = sys.stderr.isatty() if show is None else show

    def add(self, done: int, failed: int, seconds: float, key: str) -> None:
        """Count cases that were planned in ``seconds`` of processor time, of which ``key`` is the first."""
        self.done, self.failed = self.done + done, self.failed + failed
        if seconds == seconds:  # a process that died has no time
            self.seconds += seconds
            self.slowest = max(self.slowest, (seconds / max(done, 1), key))
        if self._show and time.monotonic() - self._shown > EVERY:
            self._shown = time.monotonic()
            sys.stderr.write(f"\r{self}\x1b[K")
            sys.stderr.flush()

    def end(self) -> None:
        """Write the last line."""
        if self._show:
            sys.stderr.write(f"\r{self}\x1b[K\n")

    def __str__(self) -> str:
        took = max(time.monotonic() - self._began, 1e-9)
        rate = self.done / took
        left = (self.total - self.done) / rate if rate else float("inf")
        ends = f", {left:.0f} s left" if self.done < self.total and left < float("inf") else f", {took:.0f} s"
        slowest = f", slowest {self.slowest[0]:.1f} s ({self.slowest[1]})" if self.slowest[1] else ""
        return f"{self.done} of {self.total} done, {self.failed} failed, {rate:.2f} a second{ends}{slowest}"
