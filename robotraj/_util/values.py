"""``dataclass`` as the standard library has it, made in less than half of the time.

The standard one writes six methods as text and compiles each: 0.5 ms a class, of which a plan imports over a hundred.
Here only ``__init__`` is compiled; the others are functions that all classes share. ``fields``, ``replace``,
``inspect.signature``, pickles, matching and subclasses, also of the standard kind, see no difference.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(
        cls: type | None = None, /, *, frozen: bool = False, eq: bool = True, repr: bool = True, init: bool = True
    ) -> Any:
        """Make a dataclass; methods that the class itself defines are kept, as in the standard library."""

        def make(cls: type) -> type:
            # The standard library wants a frozen class to derive from frozen ones, and freezes by compiling.
            derived = any(dataclasses.is_dataclass(base) for base in cls.__mro__[1:])
            made = dataclasses.dataclass(cls, init=init, repr=False, eq=False, frozen=frozen and derived)
            for name, method in _methods(made, frozen and not derived, eq, repr).items():
                # Python itself writes ``__hash__ = None`` into a class that defines ``__eq__``.
                if not vars(cls).get(name):
                    setattr(made, name, method)
            if eq and not frozen:
                made.__hash__ = None
            parameters = made.__dataclass_params__
            parameters.frozen, parameters.eq, parameters.repr = frozen, eq, repr
            return made

        return make if cls is None else make(cls)


def own(value: Any) -> Any:
    """Copy arrays, tuples, lists and dicts deeply, so that the caller may change the originals afterwards.

    Copies of arrays are read-only. All else, other values and functions among it, is given back as it is.
    """
    if isinstance(value, np.ndarray):
        copy = value.copy()
        copy.setflags(write=False)
        return copy
    kind = type(value)
    if kind is tuple or kind is list:
        return kind([own(entry) for entry in value])
    return {key: own(entry) for key, entry in value.items()} if kind is dict else value


def own_fields(value: Any) -> None:
    """Put ``own`` copies into the fields of a dataclass that is being made; other classes are left alone."""
    for field in dataclasses.fields(value) if dataclasses.is_dataclass(value) else ():
        object.__setattr__(value, field.name, own(getattr(value, field.name)))


def _methods(cls: type, freeze: bool, eq: bool, repr: bool) -> dict[str, Callable[..., Any]]:
    """Give what is asked for beside ``__init__``."""
    fields = dataclasses.fields(cls)
    methods: dict[str, Callable[..., Any]] = {}
    if freeze:
        methods |= _freezing(cls, frozenset(field.name for field in fields))
    if repr:
        methods["__repr__"] = _printing([field.name for field in fields if field.repr])
    if eq:
        methods["__eq__"] = _comparing(_reading([field.name for field in fields if field.compare]))
        hashed = [field.name for field in fields if (field.compare if field.hash is None else field.hash)]
        methods["__hash__"] = _hashing(_reading(hashed))
    return methods


def _freezing(cls: type, names: frozenset[str]) -> dict[str, Callable[..., None]]:
    """Fields may be set once, by ``__init__``; nothing is deleted."""

    def __setattr__(self: Any, name: str, value: Any) -> None:
        known = name in names
        if (known and name in self.__dict__) or (not known and type(self) is cls):
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        object.__setattr__(self, name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is cls or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        object.__delattr__(self, name)

    return {"__setattr__": __setattr__, "__delattr__": __delattr__}


def _printing(names: list[str]) -> Callable[[Any], str]:
    @recursive_repr()
    def __repr__(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return __repr__


def _reading(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    return lambda value: tuple([getattr(value, name) for name in names])


def _comparing(read: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any, object], Any]:
    def __eq__(self: Any, other: object) -> Any:
        return read(self) == read(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _hashing(read: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any], int]:
    return lambda self: hash(read(self))
