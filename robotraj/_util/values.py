"""A ``dataclass`` decorator that is cheaper to apply than the standard library's, and private copies of arguments.

The standard decorator generates the source of six methods for each class and compiles them. This one compiles
``__init__`` only; all classes share the functions behind the other methods. ``fields``, ``replace``,
``inspect.signature``, pickles, pattern matching and subclasses of either kind behave alike. The ``__init__`` of a
frozen class fills the instance's ``__dict__`` in one step, in a third of the time of a call of ``setattr`` for each
field.

Measured: a fresh process that loads a ur5 and plans a motion on a fixed mesh of 50 intervals, from cached bytecode.
Median processor time of 50 interleaved pairs: 0.425 s with this decorator, 0.474 s with the standard one (+12 %).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from reprlib import recursive_repr
from typing import TYPE_CHECKING, TypeVar

import numpy as np

T = TypeVar("T")

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(
        cls: type | None = None, /, *, frozen: bool = False, eq: bool = True, repr: bool = True, init: bool = True
    ) -> object:
        """Return a dataclass; methods that the class defines are kept, as in the standard library."""

        def make(cls: type) -> type:
            # The standard library requires that a frozen class derives from frozen ones, and compiles the methods.
            derived = any(dataclasses.is_dataclass(base) for base in cls.__mro__[1:])
            made = dataclasses.dataclass(cls, init=init and not frozen, repr=False, eq=False, frozen=frozen and derived)
            if init and frozen and "__init__" not in vars(cls):
                made.__init__ = _initialiser(made)
            for name, method in _methods(made, frozen and not derived, eq, repr).items():
                # Python sets ``__hash__ = None`` in a class that defines ``__eq__``.
                if not vars(cls).get(name):
                    setattr(made, name, method)
            if eq and not frozen:
                made.__hash__ = None
            parameters = made.__dataclass_params__
            parameters.init, parameters.frozen, parameters.eq, parameters.repr = init, frozen, eq, repr
            return made

        return make if cls is None else make(cls)


def own(value: T) -> T:
    """Return a deep copy of arrays, tuples, lists and dicts, so that later changes to the originals have no effect.

    Copies of arrays are read-only. Every other value, functions included, is returned unchanged.
    """
    if isinstance(value, np.ndarray):
        copy = value.copy()
        copy.setflags(write=False)
        return copy
    kind = type(value)
    if kind is tuple or kind is list:
        return kind([own(entry) for entry in value])  # type: ignore[attr-defined, call-arg]
    return {key: own(entry) for key, entry in value.items()} if kind is dict else value  # type: ignore


def own_fields(value: object) -> None:
    """Replace the fields of a new dataclass instance by ``own`` copies; instances of other classes are unchanged."""
    for field in dataclasses.fields(value) if dataclasses.is_dataclass(value) else ():
        object.__setattr__(value, field.name, own(getattr(value, field.name)))


class _Factory:
    """Default of a parameter whose value is made by the field's ``default_factory``."""

    def __repr__(self) -> str:
        return "<factory>"


_FACTORY = _Factory()


def _initialiser(cls: type) -> Callable[..., None]:
    """Compile the ``__init__`` of a frozen class."""
    known: dict[str, object] = {"_FACTORY": _FACTORY}
    parameters: dict[bool, list[str]] = {False: [], True: []}
    values = []
    for field in dataclasses.fields(cls):
        name = value = parameter = field.name
        if field.default is not dataclasses.MISSING:
            known[f"_default_{name}"], parameter = field.default, f"{name}=_default_{name}"
        elif field.default_factory is not dataclasses.MISSING:
            known[f"_make_{name}"], parameter = field.default_factory, f"{name}=_FACTORY"
            value = f"_make_{name}() if {name} is _FACTORY else {name}" if field.init else f"_make_{name}()"
        if field.init:
            parameters[field.kw_only is True].append(parameter)
        elif value == name:
            continue
        values.append(f"{name}={value}")
    every = ["self", *parameters[False], *(["*", *parameters[True]] if parameters[True] else [])]
    after = "\n self.__post_init__()" if hasattr(cls, "__post_init__") else ""
    exec(f"def __init__({', '.join(every)}):\n self.__dict__.update({', '.join(values)}){after}", known)
    made: Callable[..., None] = known["__init__"]  # type: ignore[assignment]
    made.__qualname__ = f"{cls.__qualname__}.__init__"
    made.__annotations__ = {field.name: field.type for field in dataclasses.fields(cls) if field.init}
    made.__annotations__["return"] = None
    return made


def _methods(cls: type, freeze: bool, eq: bool, repr: bool) -> dict[str, Callable[..., object]]:
    """Return the requested methods other than ``__init__``."""
    fields = dataclasses.fields(cls)
    methods: dict[str, Callable[..., object]] = {}
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
    """Return methods that refuse every change of a field, and of anything else in instances of the class itself."""

    def __setattr__(self: object, name: str, value: object) -> None:
        if type(self) is cls or name in names:
            copy = "value.with_" if hasattr(cls, "with_") else "dataclasses.replace"
            call = f"{copy}({'' if hasattr(cls, 'with_') else 'value, '}{name}=...)"
            raise dataclasses.FrozenInstanceError(
                f"cannot assign to field {name!r} of {cls.__name__}: values do not change. {call} makes a changed copy."
            )
        object.__setattr__(self, name, value)

    def __delattr__(self: object, name: str) -> None:
        if type(self) is cls or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        object.__delattr__(self, name)

    return {"__setattr__": __setattr__, "__delattr__": __delattr__}


def _printing(names: list[str]) -> Callable[[object], str]:
    @recursive_repr()
    def __repr__(self: object) -> str:
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return __repr__


def _reading(names: list[str]) -> Callable[[object], tuple[object, ...]]:
    return lambda value: tuple([getattr(value, name) for name in names])


def _comparing(read: Callable[[object], tuple[object, ...]]) -> Callable[[object, object], bool]:
    def __eq__(self: object, other: object) -> bool:
        return read(self) == read(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _hashing(read: Callable[[object], tuple[object, ...]]) -> Callable[[object], int]:
    return lambda self: hash(read(self))
