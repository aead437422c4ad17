"""Unpacking: values are made from the JSON and arrays that a ``Packer`` wrote.

Only classes of the allow-list, ``classes.CLASSES``, are made.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.solution.storage.classes import CLASSES, ENUMS, mismatch
from robotraj.solution.storage.models import model_of
from robotraj.solution.storage.plain_data import MARK, Damaged, NotPlainData

DEPTH = 60
"""Largest number of values inside each other."""

MOST_VALUES = 100_000
"""Largest number of marked values in a file; each takes some 20 us."""

T = TypeVar("T")

Arrays = Mapping[str, NDArray[np.generic]]


class Unpacker:
    """Makes values from what a ``Packer`` wrote.

    Parameters
    ----------
    arrays : mapping of str to ndarray
        The arrays that the packer stored.
    """

    def __init__(self, arrays: Arrays) -> None:
        self._stored, self._made = arrays, 0

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
        self._made += 1
        if self._made > MOST_VALUES:
            _damaged(place, f"more than {MOST_VALUES} values")
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
            _damaged(place, f"the missing entry {content!r:.80}")
        return found

    def _class(self, content: object, data: Mapping[str, object], place: str, depth: int) -> object:
        kind = CLASSES.get(content) if isinstance(content, str) else None
        if kind is None:
            raise NotPlainData(f"{place} is a {str(content)[:80]}, a class that is not made from files")
        packed = data.get("fields")
        if not isinstance(packed, dict):
            _damaged(place, f"a {content} without fields")
        given = {key: self.unpack(entry, f"{place}.{key}", depth) for key, entry in packed.items()}
        problem = mismatch(kind, given)
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
"""Errors of classes that are made from wrong values."""


def _made(make: Callable[[], T], place: str) -> T:
    """Make a value; errors of its class become one error that names the place."""
    try:
        return make()
    except (NotPlainData, Damaged):
        raise
    except REFUSALS as error:
        raise Damaged(f"{place}: {type(error).__name__}: {error}") from error


def _damaged(place: str, found: str) -> NoReturn:
    raise Damaged(f"{place} holds {found}")
