"""Forks wait until no other thread plans or imports a name of this package.

A fork copies only the calling thread. CasADi, MUMPS, cached properties and modules that are being imported have locks
that another thread may hold. The child would inherit them locked, and its first plan would hang.
"""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

PATIENCE = 60.0
"""Longest wait [s]; without it, a planning thread that waits for the forking one would deadlock."""

_changed = threading.Condition()
_inside: Counter[int] = Counter()
_forking = 0


@contextmanager
def unforked() -> Iterator[None]:
    """Delay forks of other threads until the block ends; one thread may nest such blocks."""
    me = threading.get_ident()
    with _changed:
        _changed.wait_for(lambda: not _forking or _inside[me], PATIENCE)
        _inside[me] += 1
    try:
        yield
    finally:
        with _changed:
            _inside[me] -= 1
            if not _inside[me]:
                del _inside[me]
            _changed.notify_all()


def _before() -> None:
    global _forking
    _changed.acquire()
    _forking += 1
    me = threading.get_ident()
    _changed.wait_for(lambda: not any(count and thread != me for thread, count in _inside.items()), PATIENCE)


def _after_in_parent() -> None:
    global _forking
    _forking -= 1
    _changed.notify_all()
    _changed.release()


def _after_in_child() -> None:
    global _changed, _forking
    me = threading.get_ident()
    own = _inside[me]
    _inside.clear()
    if own:
        _inside[me] = own
    _forking = 0
    _changed = threading.Condition()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before, after_in_parent=_after_in_parent, after_in_child=_after_in_child)
