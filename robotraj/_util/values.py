"""Private copies of what a caller passes in, so that values do not change when the caller's arrays do."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np


def own(value: Any) -> Any:
    """Return a deep copy of arrays, tuples, lists and dicts.

    Copies of arrays are read-only. Every other value, functions included, is returned unchanged.
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
    """Replace the fields of a new dataclass instance by ``own`` copies; instances of other classes are unchanged."""
    for field in dataclasses.fields(value) if dataclasses.is_dataclass(value) else ():
        object.__setattr__(value, field.name, own(getattr(value, field.name)))
