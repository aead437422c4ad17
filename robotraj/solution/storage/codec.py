"""Plain data as JSON and arrays: dataclasses of the allow-list, enums, containers, numbers and Pinocchio's values.

Floats survive bit for bit: JSON keeps the shortest text that reads back as the same number, arrays stay binary.
Python functions and classes outside ``classes.CLASSES`` are not written.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, NoReturn, TypeAlias, TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.solution.storage.classes import CLASSES, ENUMS, NOT_KEPT, complaint
from robotraj.solution.storage.models import model_data, model_of

MARK = "$"
"""Keys that start with this name a kind of value; mappings of users may not have such keys."""

DEPTH = 60
"""Largest number of values inside each other."""

T = TypeVar("T")

Arrays = Mapping[str, NDArray[np.generic]]


Json: TypeAlias = Any
"""JSON as ``json.loads`` returns it; who reads it checks it entry by entry."""


class NotPlainData(InputError):
    """A value that a file cannot hold, or one of a class that is not made from files; the message names it."""


class Damaged(InputError):
    """Data that no ``Packer`` wrote; the message names the place."""


class Packer:
    """Turns values into JSON; arrays are collected in ``arrays``, named by their places."""

    def __init__(self) -> None:
        self.arrays: dict[str, NDArray[np.generic]] = {}

    def pack(self, value: object, path: str) -> Json:
        """Return a value as JSON.

        Parameters
        ----------
        value : object
        path : str
            Name of its place, such as ``"phases.0.trajectory"``; arrays in it are stored under it.

        Raises
        ------
        NotPlainData
            It holds a function or a value of another class that files do not hold; nothing is stored then.
        """
        before = set(self.arrays)
        try:
            return self._pack(value, path)
        except NotPlainData:
            for name in set(self.arrays) - before:
                del self.arrays[name]
            raise

    def _pack(self, value: object, path: str) -> Json:
        if value is None or isinstance(value, str):
            return value
        if isinstance(value, bool | np.bool_):
            return bool(value)
        if isinstance(value, Enum):
            return {"$enum": self._listed(type(value), ENUMS, path), "member": value.name}
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

    def _store(self, path: str, array: NDArray[np.generic]) -> str:
        if array.dtype.kind not in "biufU":
            raise NotPlainData(f"{path} is an array of {array.dtype}, which files do not hold.")
        self.arrays[path] = array
        return path

    def _mapping(self, value: Mapping[str, object], path: str) -> dict[str, Json]:
        for key in value:
            if not isinstance(key, str) or key.startswith(MARK):
                raise NotPlainData(f"{path} has the key {key!r}; keys in files are names that do not start with $.")
        return {key: self._pack(entry, f"{path}.{key}") for key, entry in value.items()}

    def _sequence(self, value: Sequence[object], path: str) -> Json:
        mark = "$list" if isinstance(value, list) else "$tuple"
        arrays = _alike(value)
        if arrays:
            # Hundreds of small arrays, one for each interval, are stored as one.
            joined = self._store(path, np.concatenate(arrays))
            return {"$arrays": joined, "lengths": [len(part) for part in arrays], "as": mark}
        return {mark: [self._pack(entry, f"{path}.{i}") for i, entry in enumerate(value)]}

    def _dataclass(self, value: Any, path: str) -> dict[str, Json]:
        name = self._listed(type(value), CLASSES, path)
        kept = [field.name for field in fields(value) if field.init and field.name not in NOT_KEPT.get(name, ())]
        return {"$class": name, "fields": {key: self._pack(getattr(value, key), f"{path}.{key}") for key in kept}}

    def _listed(self, kind: type, known: Mapping[str, type], path: str) -> str:
        if known.get(kind.__name__) is not kind:
            raise NotPlainData(f"{path} is a {kind.__name__}, a class that files do not hold.")
        return kind.__name__

    def _foreign(self, value: object, path: str) -> Json:
        if isinstance(value, Path):
            return {"$path": str(value.absolute())}
        if isinstance(value, pin.Model):
            try:
                return {"$model": self._pack(model_data(value), path)}
            except ValueError as error:
                raise NotPlainData(f"{path}: {error}, which files do not hold.") from error
        if isinstance(value, pin.SE3):
            return {"$se3": self._store(path, np.array(value.homogeneous))}
        if isinstance(value, pin.Quaternion):
            return {"$quaternion": self._store(path, np.array(value.coeffs()))}
        raise NotPlainData(f"{path} is a {type(value).__name__}, which files do not hold.")


class Unpacker:
    """Makes values from what a ``Packer`` wrote.

    Parameters
    ----------
    arrays : mapping of str to ndarray
        The arrays that the packer stored.
    """

    def __init__(self, arrays: Arrays) -> None:
        self._stored = arrays

    def unpack(self, data: object, place: str = "value", depth: int = 0) -> Any:
        """Make a value.

        Parameters
        ----------
        data : object
            JSON.
        place : str
            Name of its place in the file, for messages.
        depth : int
            Number of values around it.

        Raises
        ------
        NotPlainData
            A class that is not on the allow-list; the value around it may do without.
        Damaged
            Data that no ``Packer`` wrote, or fields that the class refuses.
        """
        if depth > DEPTH:
            _damaged(place, f"more than {DEPTH} values inside each other")
        if isinstance(data, list):
            _damaged(place, "a list without its mark")
        if not isinstance(data, dict):
            return data
        marks = [key for key in data if key.startswith(MARK)]
        if not marks:
            return {key: self.unpack(entry, f"{place}.{key}", depth + 1) for key, entry in data.items()}
        mark = marks[0]
        read = self._READERS.get(mark)
        if read is None or len(marks) > 1:
            _damaged(place, f"the mark {mark!r}")
        return read(self, data[mark], data, place, depth + 1)

    def _entries(self, content: object, data: Mapping[str, object], place: str, depth: int) -> object:
        if not isinstance(content, list):
            _damaged(place, "a list that is none")
        entries = [self.unpack(entry, f"{place}.{i}", depth) for i, entry in enumerate(content)]
        return entries if "$list" in data else tuple(entries)

    def _arrays(self, content: object, data: Mapping[str, object], place: str, depth: int) -> object:
        joined, lengths = self._array(content, data, place, depth), data.get("lengths")
        if not isinstance(lengths, list) or not all(type(n) is int and n >= 0 for n in lengths):
            _damaged(place, "lengths that are no whole numbers")
        if joined.ndim == 0 or sum(lengths) != len(joined):
            _damaged(place, f"{joined.shape} numbers for arrays of {sum(lengths)} rows")
        parts = np.split(joined, np.cumsum(lengths)[:-1])
        return parts if data.get("as") == "$list" else tuple(parts)

    def _array(self, content: object, data: Mapping[str, object], place: str, depth: int) -> NDArray[np.generic]:
        found = self._stored.get(content) if isinstance(content, str) else None
        if found is None:
            _damaged(place, f"the missing entry {content!r}")
        return found

    def _class(self, content: object, data: Mapping[str, object], place: str, depth: int) -> object:
        kind = CLASSES.get(content) if isinstance(content, str) else None
        if kind is None:
            raise NotPlainData(f"{place} is a {str(content)[:80]}, a class that is not made from files")
        packed = data.get("fields")
        if not isinstance(packed, dict):
            _damaged(place, f"a {content} without fields")
        given = {key: self.unpack(entry, f"{place}.{key}", depth) for key, entry in packed.items()}
        problem = complaint(kind, given)
        if problem is not None:
            _damaged(place, problem)
        return _made(lambda: kind(**given), place)

    def _enum(self, content: object, data: Mapping[str, object], place: str, depth: int) -> Enum:
        kind = ENUMS.get(content) if isinstance(content, str) else None
        member = data.get("member")
        if kind is None or not isinstance(member, str) or member not in kind.__members__:
            _damaged(place, f"the unknown {content} {member!r}")
        return kind[member]

    def _float(self, content: object, data: Mapping[str, object], place: str, depth: int) -> float:
        if content not in ("inf", "-inf", "nan"):
            _damaged(place, f"the number {content!r}")
        return float(str(content))

    def _path(self, content: object, data: Mapping[str, object], place: str, depth: int) -> Path:
        if not isinstance(content, str) or "\0" in content or len(content) > 4096:
            _damaged(place, "a path that is none")
        return Path(content)

    def _model(self, content: object, data: Mapping[str, object], place: str, depth: int) -> pin.Model:
        plain = self.unpack(content, place, depth)
        if not isinstance(plain, dict):
            _damaged(place, "a model without its parts")
        return _made(lambda: model_of(plain), place)

    def _se3(self, content: object, data: Mapping[str, object], place: str, depth: int) -> pin.SE3:
        matrix = self._shaped(content, data, place, (4, 4))
        return _made(lambda: pin.SE3(matrix), place)

    def _quaternion(self, content: object, data: Mapping[str, object], place: str, depth: int) -> pin.Quaternion:
        coefficients = self._shaped(content, data, place, (4,))
        return _made(lambda: pin.Quaternion(coefficients), place)

    def _shaped(
        self, content: object, data: Mapping[str, object], place: str, shape: tuple[int, ...]
    ) -> NDArray[np.generic]:
        array = self._array(content, data, place, 0)
        if array.shape != shape or array.dtype != np.float64 or not np.isfinite(array).all():
            _damaged(place, f"an array of the shape {array.shape} where finite numbers of the shape {shape} belong")
        return array

    _READERS: Mapping[str, Callable[..., object]] = {
        "$list": _entries,
        "$tuple": _entries,
        "$arrays": _arrays,
        "$array": _array,
        "$class": _class,
        "$enum": _enum,
        "$float": _float,
        "$path": _path,
        "$model": _model,
        "$se3": _se3,
        "$quaternion": _quaternion,
    }


REFUSALS = (
    AttributeError,
    ArithmeticError,
    IndexError,
    InputError,
    KeyError,
    MemoryError,
    RecursionError,
    RuntimeError,
    TypeError,
    ValueError,
)
"""What classes raise that are made from wrong values."""


def _made(make: Callable[[], T], place: str) -> T:
    """Make a value; whatever refuses becomes one error that names the place."""
    try:
        return make()
    except (NotPlainData, Damaged):
        raise
    except REFUSALS as error:
        raise Damaged(f"{place}: {type(error).__name__}: {error}") from error


def _damaged(place: str, found: str) -> NoReturn:
    raise Damaged(f"{place} holds {found}")


def _alike(values: Sequence[object]) -> list[NDArray[np.generic]]:
    """Return the values where all are arrays that can be joined along their first axis, else an empty list."""
    arrays = [value for value in values if isinstance(value, np.ndarray) and value.ndim > 0]
    joinable = len(arrays) == len(values) and len({(array.shape[1:], array.dtype) for array in arrays}) == 1
    return arrays if joinable else []
