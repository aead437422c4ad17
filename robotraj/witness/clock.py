"""The processor time that a validation may take."""

from __future__ import annotations

import time

from robotraj._util.system.interrupts import stop_if_noted


class OutOfTime(Exception):
    """The time limit was reached."""


class ProcessorClock:
    """Processor time since a start, with a limit.

    Parameters
    ----------
    limit : float or None
        [s]; None for no limit.
    """

    def __init__(self, limit: float | None) -> None:
        self._begin = time.process_time()
        self._limit = limit

    @property
    def seconds(self) -> float:
        """Processor time since the start [s]."""
        return time.process_time() - self._begin

    @property
    def left(self) -> float | None:
        """Processor time until the limit [s], at least 0; None without one."""
        return None if self._limit is None else max(0.0, self._limit - self.seconds)

    def __call__(self) -> None:
        """Raise ``OutOfTime`` once the limit is reached, and ``KeyboardInterrupt`` after Ctrl-C."""
        stop_if_noted()
        if self._limit is not None and self.seconds > self._limit:
            raise OutOfTime
