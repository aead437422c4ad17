"""Ctrl-C during a plan: noted once, whatever code was running.

Solvers turn Ctrl-C into a status, and code between them may keep what it has. The note remains: no further solve
begins, and the plan ends as interrupted.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import NoReturn, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

_presses = 0
_before: ContextVar[int | None] = ContextVar("before", default=None)
"""Presses before the running plan; None outside of plans."""


def note() -> None:
    """Note a press of Ctrl-C."""
    global _presses
    _presses += 1


@contextmanager
def noted() -> Iterator[Callable[[], bool]]:
    """Inside the block, yield a function that returns whether Ctrl-C was pressed since its begin.

    Python's own handler raises ``KeyboardInterrupt``; it is replaced by one that notes it too, and an error after the
    press becomes ``KeyboardInterrupt``. A handler of the user's own is kept.
    """
    start = _presses
    token = _before.set(start)
    own = threading.current_thread() is threading.main_thread()
    own = own and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if own:
        signal.signal(signal.SIGINT, _note_and_raise)
    try:
        yield lambda: _presses > start
    except Exception as error:
        # Libraries turn what their callbacks raise into errors of their own.
        if own and _presses > start:
            raise KeyboardInterrupt from error
        raise
    finally:
        if own:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        _before.reset(token)


def heeded(function: Callable[P, R]) -> Callable[P, R]:
    """Let a function end with ``KeyboardInterrupt`` after a press that Python drops, as in a weakref's callback."""

    @wraps(function)
    def heeding(*arguments: P.args, **options: P.kwargs) -> R:
        with noted() as pressed:
            result = function(*arguments, **options)
            if pressed():
                raise KeyboardInterrupt
        return result

    return heeding


def stop_if_noted() -> None:
    """Raise ``KeyboardInterrupt`` where Ctrl-C was pressed since the running plan, or function that heeds it, began."""
    start = _before.get()
    if start is not None and _presses > start:
        raise KeyboardInterrupt


def _note_and_raise(*_: object) -> NoReturn:
    note()
    raise KeyboardInterrupt
