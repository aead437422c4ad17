"""Plain data as JSON and arrays: frozen dataclasses, enums, containers, numbers and Pinocchio's values.

A dataclass is written as its class and its fields, so a new constraint, objective or scheme needs no line
here. Floats survive bit for bit (JSON keeps the shortest text that reads back as the same number; arrays stay
binary). Python functions are no data: whatever holds one is refused.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError

MARK = "$"
"""Keys that start with this name a kind of value; user's mappings may not use it."""


class NotPlainData(InputError):
    """A value cannot be written, or a written one cannot be made again; the message says which and why."""


class Packer:
    """Turns values into JSON; arrays and long texts go to ``arrays``, named by where they were found."""

    def __init__(self) -> None:
        self.arrays: dict[str, np.ndarray] = {}

    def pack(self, value: Any, path: str) -> Any:
        """Write a value.

        Parameters
        ----------
        value : object
        path : str
            Name of its place, such as ``"phases.0.trajectory"``; arrays in it are stored under it.

        Raises
        ------
        NotPlainData
            It holds a function or another value that is no data; nothing is stored then.
        """
        before = set(self.arrays)
        try:
            return self._pack(value, path)
        except NotPlainData:
            for name in set(self.arrays) - before:
                del self.arrays[name]
            raise

    def _pack(self, value: Any, path: str) -> Any:
        if value is None or isinstance(value, str):
            return value
        if isinstance(value, bool | np.bool_):
            return bool(value)
        if isinstance(value, Enum):
            return {"$enum": _name(type(value)), "member": value.name}
        if isinstance(value, int | np.integer):
            return int(value)
        if isinstance(value, float | np.floating):
            return float(value) if np.isfinite(value) else {"$float": str(float(value))}
        if isinstance(value, np.ndarray):
            return {"$array": self._store(path, value)}
        if isinstance(value, Mapping):
            return self._mapping(value, path)
        if isinstance(value, Sequence) and not isinstance(value, bytes):
            return self._sequence(value, path)
        if is_dataclass(value) and not isinstance(value, type):
            return self._dataclass(value, path)
        return self._foreign(value, path)

    def _store(self, path: str, array: np.ndarray) -> str:
        if array.dtype.kind not in "biufU":
            raise NotPlainData(f"{path} is an array of {array.dtype}, which is no plain data.")
        self.arrays[path] = array
        return path

    def _mapping(self, value: Mapping[Any, Any], path: str) -> dict[str, Any]:
        for key in value:
            if not isinstance(key, str) or key.startswith(MARK):
                raise NotPlainData(f"{path} has the key {key!r}; only names can be written.")
        return {key: self._pack(entry, f"{path}.{key}") for key, entry in value.items()}

    def _sequence(self, value: Sequence[Any], path: str) -> Any:
        mark = "$list" if isinstance(value, list) else "$tuple"
        if _alike(value):
            # Hundreds of small arrays, one an interval, are stored as one.
            joined = self._store(path, np.concatenate(value))
            return {"$arrays": joined, "lengths": [len(part) for part in value], "as": mark}
        return {mark: [self._pack(entry, f"{path}.{i}") for i, entry in enumerate(value)]}

    def _dataclass(self, value: Any, path: str) -> dict[str, Any]:
        kind = type(value)
        names = [field.name for field in fields(value) if field.init]
        if not kind.__dataclass_params__.init:
            raise NotPlainData(f"{path} is a {kind.__name__}, which is not made from its fields.")
        entries = {name: self._pack(getattr(value, name), f"{path}.{name}") for name in names}
        return {"$class": _name(kind), "fields": entries}

    def _foreign(self, value: Any, path: str) -> Any:
        if isinstance(value, Path):
            return {"$path": str(value.absolute())}
        if isinstance(value, pin.Model):
            return {"$model": self._store(path, np.array(value.saveToString()))}
        if isinstance(value, pin.SE3):
            return {"$se3": self._store(path, np.array(value.homogeneous))}
        if isinstance(value, pin.Quaternion):
            return {"$quaternion": self._store(path, np.array(value.coeffs()))}
        raise NotPlainData(f"{path} is a {type(value).__name__}, which is no plain data.")


class Unpacker:
    """Makes values again from what a Packer wrote.

    Parameters
    ----------
    arrays : mapping of str to ndarray
        What the packer stored.
    """

    def __init__(self, arrays: Mapping[str, np.ndarray]) -> None:
        self._stored = arrays

    def unpack(self, data: Any) -> Any:
        """Make a value again.

        Raises
        ------
        NotPlainData
            A class it needs does not exist here.
        InputError
            The class refuses the fields.
        """
        if not isinstance(data, dict):
            return data
        mark = next((key for key in data if key.startswith(MARK)), None)
        if mark is None:
            return {key: self.unpack(entry) for key, entry in data.items()}
        content = data[mark]
        if mark in ("$list", "$tuple"):
            return _KINDS[mark](self.unpack(entry) for entry in content)
        if mark == "$arrays":
            parts = np.split(self._stored[content], np.cumsum(data["lengths"])[:-1])
            return _KINDS[data["as"]](parts)
        if mark == "$class":
            kind = _class(content)
            return kind(**{key: self.unpack(entry) for key, entry in data["fields"].items()})
        if mark == "$enum":
            return _class(content)[data["member"]]
        if mark in _FROM_TEXT:
            return _FROM_TEXT[mark](content)
        return _FROM_ARRAY[mark](self._stored[content])


def _model(text: np.ndarray) -> pin.Model:
    model = pin.Model()
    model.loadFromString(str(text))
    return model


_KINDS: dict[str, Callable[[Iterable[Any]], Any]] = {"$list": list, "$tuple": tuple}
_FROM_TEXT: dict[str, Callable[[str], Any]] = {"$float": float, "$path": Path}
_FROM_ARRAY: dict[str, Callable[[np.ndarray], Any]] = {
    "$array": lambda array: array,
    "$model": _model,
    "$se3": pin.SE3,
    "$quaternion": pin.Quaternion,
}


def _alike(values: Sequence[Any]) -> bool:
    """Whether these are arrays that can be joined along their first axis."""
    if not values or not all(isinstance(value, np.ndarray) and value.ndim > 0 for value in values):
        return False
    return len({(value.shape[1:], value.dtype) for value in values}) == 1


def _name(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


def _class(name: str) -> Any:
    """Find a dataclass or enum by its full name: robotraj's are imported, a user's must have been already."""
    module, _, short = name.rpartition(".")
    if module.split(".")[0] == __name__.split(".")[0]:
        with suppress(ImportError):
            import_module(module)
    kind = getattr(sys.modules.get(module), short, None)
    if not isinstance(kind, type) or not (is_dataclass(kind) or issubclass(kind, Enum)):
        raise NotPlainData(f"There is no class {name} here; import the module that defines it first.")
    return kind
