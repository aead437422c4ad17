"""Sequences that are computed when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar, overload

T = TypeVar("T", covariant=True)


class Late(Sequence[T]):
    """A sequence of values that most callers do not read.

    Parameters
    ----------
    find : callable
        Returns the values; it is called once.
    count : int, optional
        How many there will be; with it, ``len`` computes nothing.
    """

    def __init__(self, find: Callable[[], Sequence[T]], count: int | None = None) -> None:
        self._find: Callable[[], Sequence[T]] | None = find
        self._found: tuple[T, ...] = ()
        self._count = count

    def _all(self) -> tuple[T, ...]:
        if self._find is not None:
            # The callable may hold a whole NLP; release it.
            self._found, self._find = tuple(self._find()), None
        return self._found

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[T, ...]: ...
    def __getitem__(self, index: int | slice) -> T | tuple[T, ...]:
        return self._all()[index]

    def __len__(self) -> int:
        return len(self._all()) if self._count is None else self._count

    def __eq__(self, other: object) -> bool:
        return self._all() == (other._all() if isinstance(other, Late) else other)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type, tuple[tuple[T, ...]]]:
        # A copy, or a value that comes back from another process, holds the values themselves.
        return tuple, (self._all(),)

    def __repr__(self) -> str:
        return f"<{len(self)} values>" if self._find is None or self._count is not None else "<not computed yet>"
