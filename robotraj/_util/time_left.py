"""Remaining time of the running plan, for code that waits for other processes."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_known: ContextVar[Callable[[], float] | None] = ContextVar("known", default=None)


@contextmanager
def limited(left: Callable[[], float] | None) -> Iterator[None]:
    """Inside the block ``time_left`` reads the remaining time [s] from ``left``; None sets no limit."""
    token = _known.set(left)
    try:
        yield
    finally:
        _known.reset(token)


def time_left() -> float:
    """Return the time [s] that the plan has left, infinite without a limit and never below 0."""
    left = _known.get()
    return math.inf if left is None else max(0.0, left())


def used_time() -> float:
    """Return the processor time [s] of this process, and of the compilers that it started and that have ended."""
    others = os.times()
    return time.process_time() + others.children_user + others.children_system
