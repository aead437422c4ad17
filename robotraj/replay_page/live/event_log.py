"""The events of a watched plan, which every listener gets from the start."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice

MOST_BYTES = 64 * 10**6
"""Size of the kept events; the oldest ones after the first, which draws the robot, are dropped above it."""


class EventLog:
    """Events as bytes, appended by the plan and followed by any number of threads."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._kept: dict[int, bytes] = {}
        self._count = self._size = self._listeners = 0
        self._ended = self._arrived = False

    def add(self, event: bytes) -> None:
        """Append an event."""
        with self._changed:
            self._kept[self._count] = event
            self._count += 1
            self._size += len(event)
            while self._size > MOST_BYTES and len(self._kept) > 2:
                self._size -= len(self._kept.pop(next(islice(self._kept, 1, None))))
            self._changed.notify_all()

    @contextmanager
    def listening(self) -> Iterator[Iterator[bytes]]:
        """Yield the events from the first on, as they come, until the last one."""
        with self._changed:
            self._listeners += 1
            self._arrived = True
            self._changed.notify_all()
        try:
            yield self._follow()
        finally:
            with self._changed:
                self._listeners -= 1
                self._changed.notify_all()

    def _follow(self) -> Iterator[bytes]:
        number = 0
        while True:
            with self._changed:
                self._changed.wait_for(lambda number=number: self._count > number or self._ended)  # type: ignore[misc]
                if self._count <= number:
                    return
                event = self._kept.get(number)
            number += 1
            if event is not None:
                yield event

    def wait_for_listener(self, seconds: float) -> None:
        """Wait until somebody listens."""
        with self._changed:
            self._changed.wait_for(lambda: self._arrived, seconds)

    def end(self, seconds: float) -> None:
        """Let listeners stop after the last event, and wait for them."""
        until = time.monotonic() + seconds
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._listeners, max(0.0, until - time.monotonic()))
