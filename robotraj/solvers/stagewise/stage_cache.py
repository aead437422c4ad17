"""Values that are computed once for the point functions of a phase, however often its problem is reduced.

A phase keeps its point functions from one transcription to the next, and with them their derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar
from weakref import WeakKeyDictionary

from robotraj.transcription.assembly.point_functions import PointFunctions

T = TypeVar("T")


class StageCache(Generic[T]):
    """Results by point functions and arguments, kept as long as the point functions exist."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[PointFunctions, dict[Hashable, T]] = WeakKeyDictionary()

    def get(self, stage: PointFunctions, arguments: Hashable, make: Callable[[], T]) -> T:
        """Return the value of ``make`` for the point functions and these arguments."""
        known = self._known.setdefault(stage, {})
        if arguments not in known:
            known[arguments] = make()
        return known[arguments]
