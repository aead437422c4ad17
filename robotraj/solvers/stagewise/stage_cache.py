"""Values that are computed once for each stage, also where its problem is reduced several times.

A phase keeps its stage from one transcription to the next, and with the stage the derivatives that belong to it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar
from weakref import WeakKeyDictionary

from robotraj.transcription.assembly.point_functions import PointFunctions

T = TypeVar("T")


class Kept(Generic[T]):
    """Results by stage and arguments, as long as the stage lives."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[PointFunctions, dict[Hashable, T]] = WeakKeyDictionary()

    def get(self, stage: PointFunctions, arguments: Hashable, make: Callable[[], T]) -> T:
        """Return the value of ``make`` for the stage and these arguments."""
        known = self._known.setdefault(stage, {})
        if arguments not in known:
            known[arguments] = make()
        return known[arguments]
