"""Packing: values become JSON and arrays.

Dataclasses of the allow-list, enums, containers, numbers and values of Pinocchio are packed. Python functions and
classes outside ``classes.CLASSES`` are refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.solution.storage.classes import CLASSES, ENUMS, NOT_KEPT
from robotraj.solution.storage.models import model_data
from robotraj.solution.storage.plain_data import MARK, Json, NotPlainData

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


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

    def _dataclass(self, value: DataclassInstance, path: str) -> dict[str, Json]:
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


def _alike(values: Sequence[object]) -> list[NDArray[np.generic]]:
    """Return the values where all are arrays that can be joined along their first axis, else an empty list."""
    arrays = [value for value in values if isinstance(value, np.ndarray) and value.ndim > 0]
    joinable = len(arrays) == len(values) and len({(array.shape[1:], array.dtype) for array in arrays}) == 1
    return arrays if joinable else []
