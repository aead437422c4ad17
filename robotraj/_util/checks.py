"""What a value is, before it is compared: text, None and arrays are no numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from robotraj._util.errors import InputError


def is_number(value: object) -> bool:
    """Whether a value is one real number; a flag is none."""
    return isinstance(value, float | int | np.floating | np.integer) and not isinstance(value, bool)


def is_whole(value: object) -> bool:
    """Whether a value is one whole number; a flag is none."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def names(what: str, given: object) -> list[str]:
    """Return a list of names.

    Raises
    ------
    InputError
        The value is one string, or no iterable of strings; ``what`` names it.
    """
    listed: list[Any] = list(given) if isinstance(given, Iterable) and not isinstance(given, str | bytes) else [given]
    if isinstance(given, str | bytes) or not all(isinstance(name, str) for name in listed):
        raise InputError(f"{what} must be a list of names, got {given!r}.")
    return listed
