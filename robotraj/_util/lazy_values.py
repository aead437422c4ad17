"""Sequences and properties that are computed when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, overload

if TYPE_CHECKING:
    # A property for type checkers: all of them accept it for the attribute of a protocol.
    from builtins import property as cached_property
else:

    class cached_property:
        """A property whose first value is kept in the instance's ``__dict__``, without a lock.

        Until Python 3.11 ``functools.cached_property`` holds one lock for all instances of a class. If a process forks
        while another thread computes a property, the child inherits the locked lock and deadlocks. Without a lock two
        threads may compute a value at once; both return the first result.

        Pickles and copies of the instance have no cached values. These may be functions or programs of libraries, which
        cannot be pickled; a copy computes its own when they are read.
        """

        def __init__(self, function):
            self.func, self.name, self.__doc__ = function, function.__name__, function.__doc__

        def __set_name__(self, owner, name):
            self.name = name
            if getattr(owner, "__getstate__", None) is getattr(object, "__getstate__", None):
                owner.__getstate__ = without_cached_values

        def __get__(self, instance, owner=None):
            if instance is None:
                return self
            known = instance.__dict__
            return known[self.name] if self.name in known else known.setdefault(self.name, self.func(instance))


def without_cached_values(self: object) -> dict[str, Any]:
    """Return the state of an instance for a pickle or a copy: its attributes without values of cached properties."""
    kind = type(self)
    return {name: own for name, own in vars(self).items() if not isinstance(getattr(kind, name, None), cached_property)}


__all__ = ["LazySequence", "cached_property", "without_cached_values"]

T = TypeVar("T", covariant=True)


class LazySequence(Sequence[T]):
    """A sequence whose values are computed when one of them is first read.

    Parameters
    ----------
    find : callable
        Returns the values; it is called once.
    count : int, optional
        Number of values. With it, ``len`` does not compute them.
    travels : bool
        Whether a pickle or a copy holds ``find``, which is small, and not the values, which would be computed for it.
    """

    def __init__(self, find: Callable[[], Sequence[T]], count: int | None = None, travels: bool = False) -> None:
        self._find: Callable[[], Sequence[T]] | None = find
        self._found: tuple[T, ...] = ()
        self._count = count
        self._travels = travels

    def _all(self) -> tuple[T, ...]:
        if self._find is not None:
            # The callable may hold a whole NLP; release it.
            self._found, self._find = tuple(self._find()), None
        return self._found

    @property
    def found(self) -> bool:
        """Whether the values were computed."""
        return self._find is None

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[T, ...]: ...
    def __getitem__(self, index: int | slice) -> T | tuple[T, ...]:
        return self._all()[index]

    def __len__(self) -> int:
        return len(self._all()) if self._count is None else self._count

    def __eq__(self, other: object) -> bool:
        return self._all() == (other._all() if isinstance(other, LazySequence) else other)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        if self._find is not None and self._travels:
            return LazySequence, (self._find, self._count, True)
        # A copy, or a value that comes back from another process, holds the values themselves.
        return tuple, (self._all(),)

    def __repr__(self) -> str:
        return f"<{len(self)} values>" if self._find is None or self._count is not None else "<not computed yet>"
