"""Limits of the running plan, for code that waits for other processes or makes calls that cannot be interrupted."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Protocol


class LimitReached(KeyboardInterrupt):
    """Raised at a limit. It ends a plan as Ctrl-C does, and the best solution so far is returned."""


class LimitsOfPlan(Protocol):
    """Limits of a plan."""

    @property
    def left(self) -> float:
        """Time that is left [s]."""

    def require(self, seconds: float, megabytes: float) -> None:
        """Raise ``LimitReached`` if less time or memory is left."""


_known: ContextVar[LimitsOfPlan | None] = ContextVar("known", default=None)


@contextmanager
def limited(limits: LimitsOfPlan | None) -> Iterator[None]:
    """Inside the block, ``time_left`` and ``require`` read these limits; None sets no limit."""
    token = _known.set(limits)
    try:
        yield
    finally:
        _known.reset(token)


def time_left() -> float:
    """Return the time [s] that the plan has left, infinite without a limit and never below 0."""
    limits = _known.get()
    return math.inf if limits is None else max(0.0, limits.left)


def is_limited() -> bool:
    """Whether the running plan has limits."""
    return _known.get() is not None


def require(seconds: float, megabytes: float) -> None:
    """Announce a call that cannot be interrupted.

    Parameters
    ----------
    seconds, megabytes : float
        Estimates of its time [s] and memory [MB].

    Raises
    ------
    LimitReached
        The plan has less time or memory left.
    """
    limits = _known.get()
    if limits is not None:
        limits.require(seconds, megabytes)


def used_time() -> float:
    """Return the processor time [s] of this process, and of the compilers that it started and that have ended."""
    others = os.times()
    return time.process_time() + others.children_user + others.children_system
