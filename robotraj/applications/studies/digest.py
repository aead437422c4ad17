"""Digests of what a case is planned from: functions by their code and what they read, robots by their models.

Two functions of the same code, constants and closures have one digest, whatever file or process they come from.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from types import CodeType, FunctionType, ModuleType
from typing import TYPE_CHECKING, cast

import cloudpickle
import numpy as np

from robotraj.robot.coupling.coupled_model import uncoupled
from robotraj.robot.robot import Robot

if TYPE_CHECKING:
    from hashlib import _Hash

LENGTH = 20
"""Hexadecimal digits of a digest."""


def digest_of(*values: object) -> str:
    """Return the digest of values, as hexadecimal digits."""
    found, seen = hashlib.sha256(), dict[int, tuple[int, object]]()
    for value in values:
        _add(found, value, seen)
    return found.hexdigest()[:LENGTH]


def _add(found: _Hash, value: object, seen: dict[int, tuple[int, object]]) -> None:
    """Add a value and what it refers to; one that was added before counts by its number."""
    found.update(f"{type(value).__name__}:".encode())
    if value is None or isinstance(value, str | bytes | bool | int | float | complex):
        found.update(repr(value).encode())
        return
    if id(value) in seen:
        found.update(str(seen[id(value)][0]).encode())
        return
    # The value is kept, so that no other value has its number meanwhile.
    seen[id(value)] = len(seen), value
    if isinstance(value, np.ndarray | np.generic):
        array = np.asarray(value)
        found.update(f"{array.dtype}{array.shape}".encode() + array.tobytes())
    elif isinstance(value, Robot):
        _add(found, [uncoupled(value.model).saveToString(), *map(str, value.followers)], seen)
        _add(found, [value.actuated, value.limits, value.root, value.springs], seen)
    elif isinstance(value, ModuleType):
        _add(found, value.__name__, seen)
    elif isinstance(value, CodeType):
        _add(found, [value.co_code, value.co_consts, value.co_names, value.co_varnames], seen)
    elif isinstance(value, FunctionType):
        if value.__module__.partition(".")[0] == "robotraj":
            # The version of the package stands for its functions.
            _add(found, [value.__module__, value.__qualname__], seen)
            return
        cells = [cell.cell_contents for cell in value.__closure__ or ()]
        names = sorted(_names(value.__code__) & value.__globals__.keys())
        _add(found, [value.__code__, value.__defaults__, value.__kwdefaults__, cells], seen)
        _add(found, {name: value.__globals__[name] for name in names}, seen)
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            _add(found, key, seen)
            _add(found, entry, seen)
    elif isinstance(value, set | frozenset):
        found.update("".join(sorted(digest_of(entry) for entry in cast("set[object]", value))).encode())
    elif isinstance(value, tuple | list):
        found.update(str(len(value)).encode())
        for entry in value:
            _add(found, entry, seen)
    elif isinstance(value, type):
        _add(found, f"{value.__module__}.{value.__qualname__}", seen)
    elif hasattr(value, "__dataclass_fields__"):
        _add(found, [f"{type(value).__module__}.{type(value).__qualname__}"], seen)
        _add(found, {name: getattr(value, name) for name in value.__dataclass_fields__}, seen)
    else:
        found.update(cloudpickle.dumps(value))


def _names(code: CodeType) -> set[str]:
    """Names that a function and the functions inside it read from their module."""
    inner = (_names(each) for each in code.co_consts if isinstance(each, CodeType))
    return set(code.co_names).union(*inner)
