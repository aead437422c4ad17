"""Whether a value is of the kind that an annotation states, asked after a call has failed.

Annotations are read when they are needed, with the names of the loaded modules, so that importing stays fast. A value
is refused only where it is certainly of another kind: names that are unknown state nothing.
"""

from __future__ import annotations

import builtins
import collections.abc
import sys
import types
import typing
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np
import numpy.typing as npt

from robotraj._util.checks import is_number
from robotraj._util.printing import brief

DEPTH = 6
"""Levels of values inside values that are looked at."""
MOST = 1000
"""Entries of a list that are looked at."""
SOURCES = {"Robot": "rt.load", "Solution": "rt.plan", "Phase": "rt.Phase", "Problem": "rt.Problem", "Mesh": "rt.Mesh"}
"""Public calls that return values which other calls take."""
_OURS = __name__.partition(".")[0]
_NUMBERS = (npt.ArrayLike, np.ndarray)
_UNIONS = (types.UnionType, typing.Union)
_WORDS = {str: "text", float: "a number", int: "a whole number", bool: "True or False", types.NoneType: "None"}


def misfit(function: Callable[..., Any], name: str, arguments: Mapping[str, object]) -> str:
    """Return a sentence on the first argument, or value inside one, that is of another kind than stated; "" for none.

    Parameters
    ----------
    function : callable
        Its annotations state the kinds.
    name : str
        By which users call it.
    arguments : mapping
        Values by the names of the parameters.
    """
    stated, module = getattr(function, "__annotations__", {}), sys.modules.get(function.__module__ or "", builtins)
    for argument, value in arguments.items():
        if argument in stated and (
            found := _wrong(f"{argument}= of {name}", value, _kind(stated[argument], vars(module)), 0)
        ):
            return found
    return ""


class _Names(dict[str, object]):
    """Names of a module, then those that one loaded module of this project has, or several have in common."""

    def __missing__(self, name: str) -> object:
        modules = [vars(each) for key, each in list(sys.modules.items()) if key.partition(".")[0] == _OURS]
        found = [names[name] for names in modules if name in names]
        if found and all(str(each) == str(found[0]) for each in found):
            return found[0]
        if found or not hasattr(builtins, name):
            return Any
        raise KeyError(name)


def _kind(annotation: object, names: Mapping[str, object]) -> Any:
    """Return the type that an annotation states; ``Any`` where it cannot be read."""
    if not isinstance(annotation, str):
        return annotation
    holder = types.SimpleNamespace(__annotations__={"kind": annotation})
    try:
        return typing.get_type_hints(holder, {}, _Names(names))["kind"]
    except (TypeError, AttributeError, NameError, SyntaxError):
        return Any


def _wrong(place: str, value: object, kind: Any, depth: int) -> str:
    if not _fits(value, kind):
        wanted = _written(kind)
        return f"{place} must be {wanted}; got {brief(value)}." if wanted else ""
    if depth < DEPTH:
        for inner, part, stated in _parts(place, value):
            if found := _wrong(inner, part, stated, depth + 1):
                return found
    return ""


def _parts(place: str, value: object) -> Iterator[tuple[str, object, Any]]:
    """Return the fields of a value of this project, or the entries of a list, with their places and kinds."""
    if isinstance(value, list | tuple):
        yield from ((place, part, Any) for part in value[:MOST])
    elif isinstance(value, dict):
        yield from ((place, part, Any) for part in list(value.values())[:MOST])
    elif is_dataclass(value) and not isinstance(value, type) and type(value).__module__.partition(".")[0] == _OURS:
        for field in fields(value):
            names = vars(sys.modules[_owner(type(value), field.name).__module__])
            if field.init and field.name in vars(value):
                yield (
                    f"{field.name}= of {type(value).__name__}",
                    vars(value)[field.name],
                    _kind(field.type, names),
                )


def _owner(cls: type, field: str) -> type:
    return next((each for each in cls.__mro__ if field in vars(each).get("__annotations__", {})), cls)


def _fits(value: object, kind: Any) -> bool:
    """Whether a value may be of a kind."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if kind in _NUMBERS or origin is np.ndarray:
        return _are_numbers(value) and (kind is npt.ArrayLike or not is_number(value))
    if origin in _UNIONS:
        return any(_fits(value, each) for each in inner)
    if origin is collections.abc.Callable:
        return callable(value)
    cls = origin or kind
    if not isinstance(cls, type) or cls in (object, Any):
        return True
    if cls in (float, int):
        return is_number(value) or (isinstance(value, np.ndarray) and value.size == 1 and value.dtype.kind in "biuf")
    if cls is bool:
        return isinstance(value, bool | np.bool_)
    if getattr(cls, "_is_protocol", False) and cls.__module__.partition(".")[0] == _OURS:
        return all(hasattr(value, name) for name in dir(cls) if not name.startswith("_"))
    if issubclass(cls, str) and not issubclass(cls, Enum):
        return isinstance(value, str)
    if issubclass(cls, collections.abc.Iterable) and cls.__module__ in ("builtins", "collections.abc"):
        return _is_several(value, cls, inner)
    return isinstance(value, cls)


def _is_several(value: object, cls: type, inner: tuple[Any, ...]) -> bool:
    """Whether a value has entries of a kind; arrays and other lists stand for sequences and tuples."""
    if issubclass(cls, collections.abc.Mapping):
        if not hasattr(value, "items"):
            return False
        entries = value.items() if isinstance(value, dict) and len(inner) == 2 else ()
        return all(_fits(key, inner[0]) and _fits(entry, inner[1]) for key, entry in entries)
    if isinstance(value, str | bytes | Mapping):
        return False
    try:
        iter(value)  # type: ignore[call-overload]
    except Exception:  # arrays without dimensions and symbols have the method, and raise what they like
        return False
    if isinstance(value, np.ndarray):
        value = value[:MOST].tolist()
    if issubclass(cls, collections.abc.Sequence) and not hasattr(type(value), "__getitem__"):
        return False
    if isinstance(value, list | tuple):
        if len(inner) > 1 and inner[-1] is not Ellipsis:
            return len(value) == len(inner) and all(map(_fits, value, inner))
        return all(_fits(entry, inner[0]) for entry in value[:MOST]) if inner else True
    return True


def _are_numbers(value: object) -> bool:
    try:
        return np.asarray(value).dtype.kind in "biuf"
    except Exception:  # ragged lists, and symbols that raise what they like
        return False


def _written(kind: Any) -> str:
    """Write a kind for a message; empty where there is no plain word for it."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if kind in _NUMBERS or origin is np.ndarray:
        return "numbers"
    if origin in _UNIONS:
        words = list(dict.fromkeys(_written(each) for each in inner))
        return " or ".join(words) if all(words) else ""
    if origin is collections.abc.Callable:
        return "a function"
    cls = origin or kind
    if cls in _WORDS:
        return _WORDS[cls]
    if not isinstance(cls, type):
        return ""
    if issubclass(cls, collections.abc.Mapping):
        return "a dict"
    if issubclass(cls, collections.abc.Iterable) and cls.__module__ in ("builtins", "collections.abc"):
        of = _written(inner[0]) if inner else ""
        count = f"{len(inner)} " if len(inner) > 1 and inner[-1] is not Ellipsis else "a list of "
        return f"{count}numbers" if of in ("a number", "a whole number") else f"a list{of and ': each '}{of}"
    source = SOURCES.get(cls.__name__, "")
    return f"{'an' if cls.__name__[0] in 'AEIOU' else 'a'} {cls.__name__}{source and ' as returned by '}{source}"
