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
from types import CodeType, FrameType
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

_IMPORTS = "<frozen importlib._bootstrap>"
"""File of Python's own functions that import a module."""

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


@contextmanager
def undisturbed() -> Iterator[None]:
    """Let a press of Ctrl-C wait until the block ends, such as an import: one that stops half-way fails ever after."""
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler) or threading.current_thread() is not threading.main_thread():
        yield
        return
    waiting: list[tuple[int, FrameType | None]] = []
    signal.signal(signal.SIGINT, lambda *press: waiting.append(press))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if waiting:
            handler(*waiting[0])


def stop_if_noted() -> None:
    """Raise ``KeyboardInterrupt`` where Ctrl-C was pressed since the running plan, or function that heeds it, began."""
    start = _before.get()
    if start is not None and _presses > start:
        raise KeyboardInterrupt


class HeldBack:
    """Between ``begin`` and ``end``, a press of Ctrl-C waits while one of the functions runs, and is heeded elsewhere.

    A press that waited is heeded at the end. The running functions are found on the stack of the press, so that no
    instant lies between them and the block that they surround.

    Parameters
    ----------
    *codes : types.CodeType
        The ``__code__`` of Python functions, such as ``__enter__`` and ``__exit__`` of a context manager.
    """

    def __init__(self, *codes: CodeType) -> None:
        self._codes = codes
        self._handler: Callable[[int, FrameType | None], object] | None = None
        self._waiting: tuple[int, FrameType | None] | None = None

    def begin(self) -> None:
        """Take the place of the handler, where there is one and this is the main thread."""
        handler = signal.getsignal(signal.SIGINT)
        if callable(handler) and threading.current_thread() is threading.main_thread():
            self._handler = handler
            signal.signal(signal.SIGINT, self._heed)

    def end(self) -> None:
        """Put the handler back, and hand it the press that waited."""
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
            if self._waiting is not None:
                self._handler(*self._waiting)

    def _heed(self, number: int, frame: FrameType | None) -> None:
        running = frame
        while running is not None:
            if running.f_code in self._codes:
                self._waiting = number, frame
                return
            running = running.f_back
        assert self._handler is not None
        self._handler(number, frame)


def _note_and_raise(_: int, frame: FrameType | None) -> None:
    """Note a press, and raise it unless a module is being imported: libraries catch every error there."""
    note()
    while frame is not None:
        if frame.f_code.co_filename == _IMPORTS:
            return
        frame = frame.f_back
    raise KeyboardInterrupt
